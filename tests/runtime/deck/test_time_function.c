/* Loads in time: values at marked points, integrals against a quadrature of the values. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "runtime/deck/time_function.h"

static const double times[] = {0.1, 0.4, 0.5, 0.9}, values[] = {2, -1, -1, 3};
static double integrals[4];

static const time_function constant = {.shape = TIME_CONSTANT, .value = 3, .start = 0.25};
static const time_function ramp = {.shape = TIME_RAMP, .value = 3, .start = 0.25, .rise = 0.5};
static const time_function hold = {.shape = TIME_RAMP_HOLD, .value = 3, .start = 0.25, .rise = 0.5};
static const time_function cosine = {.shape = TIME_COSINE, .value = 3, .start = 0.25, .rise = 0.5};
static const time_function table = {.shape = TIME_TABLE,
                                    .start = 0.25,
                                    .times = times,
                                    .values = values,
                                    .integrals = integrals,
                                    .count = 4};
static const time_function *const all[] = {&constant, &ramp, &hold, &cosine, &table};

static void near(double got, double expected) {
  if (!(fabs(got - expected) <= 1e-14)) fail_msg("%.17g instead of %.17g", got, expected);
}

static void values_at_marked_points(void **state) {
  (void)state;
  for (int k = 0; k < 5; k++) {
    near(time_function_at(all[k], 0.2499), 0);
    near(time_function_integral(all[k], 0.2499), 0);
    near(time_function_integral(all[k], 0.25), 0);
  }
  near(time_function_at(&constant, 0.25), 3);
  near(time_function_at(&constant, 7), 3);
  near(time_function_at(&ramp, 0.5), 1.5);
  near(time_function_at(&ramp, 1.25), 6); /* goes on */
  near(time_function_at(&hold, 0.5), 1.5);
  near(time_function_at(&hold, 1.25), 3);
  near(time_function_at(&cosine, 0.5), 1.5);
  near(time_function_at(&cosine, 0.25 + 0.5 / 3), 3 * 0.25); /* (1 - cos 60 deg)/2 */
  near(time_function_at(&cosine, 1.25), 3);
  near(time_function_at(&table, 0.25), 2); /* held before the first point */
  near(time_function_at(&table, 0.25 + 0.25), 0.5);
  near(time_function_at(&table, 0.25 + 0.7), 1);
  near(time_function_at(&table, 9), 3);
}

/* Composite Simpson between kinks is exact for straight pieces and of 4th order for the cosine. */
static double quadrature(const time_function *f, double from, double to) {
  enum { PIECES = 2000 };
  double h = (to - from) / PIECES, sum = 0;
  for (int i = 0; i < PIECES; i++) {
    double t = from + i * h;
    sum +=
        h / 6 *
        (time_function_at(f, t) + 4 * time_function_at(f, t + h / 2) + time_function_at(f, t + h));
  }
  return sum;
}

static void integrals_are_exact(void **state) {
  (void)state;
  static const double kinks[] = {0.25, 0.35, 0.65, 0.75, 1.15, 2.0};
  for (int k = 0; k < 5; k++) {
    double sum = 0;
    for (int i = 0; i + 1 < 6; i++) {
      double middle = (kinks[i] + kinks[i + 1]) / 2;
      double half = sum + quadrature(all[k], kinks[i], middle);
      assert_true(fabs(time_function_integral(all[k], middle) - half) < 1e-11);
      sum = half + quadrature(all[k], middle, kinks[i + 1]);
      assert_true(fabs(time_function_integral(all[k], kinks[i + 1]) - sum) < 1e-11);
    }
  }
}

/* Against central differences of the values, away from kinks. */
static void slopes_are_those_of_the_values(void **state) {
  (void)state;
  static const double at[] = {0.1, 0.3, 0.45, 0.6, 0.7, 0.85, 1.0, 1.3};
  const double h = 1e-6;
  for (int k = 0; k < 5; k++)
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
      const double rise = time_function_at(all[k], at[i] + h) - time_function_at(all[k], at[i] - h);
      assert_true(fabs(time_function_slope(all[k], at[i]) - rise / (2 * h)) < 1e-8);
    }
}

static void rises_meet_their_plateau(void **state) {
  (void)state;
  /* ramp and cosine both move half of value*rise while they rise */
  near(time_function_integral(&hold, 0.75), 0.75);
  near(time_function_integral(&cosine, 0.75), 0.75);
  near(time_function_integral(&hold, 1.75), 3.75);
  near(time_function_integral(&cosine, 1.75), 3.75);
  assert_true(fabs(time_function_at(&cosine, nextafter(0.75, 0)) - 3) < 1e-12);
}

int main(void) {
  time_table_integrals(times, values, 4, integrals);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(values_at_marked_points), cmocka_unit_test(integrals_are_exact),
      cmocka_unit_test(slopes_are_those_of_the_values), cmocka_unit_test(rises_meet_their_plateau)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
