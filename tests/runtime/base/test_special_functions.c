/* Functions of distributions against the library's long double ones. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>

#include "runtime/base/random_number.h"
#include "runtime/base/special_functions.h"

enum { SAMPLES = 100000 };

static double uniform(uint64_t *state, double low, double high) {
  return low + (high - low) * random_unit(random_mix((*state)++));
}

/* 10^exponent with either sign. */
static double sized(uint64_t *state, double low, double high) {
  const double size = pow(10, uniform(state, low, high));
  return random_mix((*state)++) & 1 ? size : -size;
}

static double ulps(double got, long double exact) {
  const double rounded = (double)exact;
  if (got == rounded && (isinf(got) || got == 0)) return 0;
  const int exponent = ilogbl(exact) - 52;
  return (double)fabsl(((long double)got - exact) / ldexpl(1, exponent < -1074 ? -1074 : exponent));
}

/* The largest error is printed and stays below `bound` ulp. */
#define WITHIN(bound, got, exact, sample)                                                          \
  do {                                                                                             \
    uint64_t state = 1;                                                                            \
    double worst = 0, at = 0;                                                                      \
    for (int k = 0; k < SAMPLES; k++) {                                                            \
      const double x = sample, error = ulps(got(x), exact((long double)x));                        \
      if (!(error <= worst)) worst = error, at = x;                                                \
    }                                                                                              \
    printf("  %-24s %-28s %.2f ulp at %a\n", #got, #sample, worst, at);                            \
    if (!(worst <= (bound))) fail_msg(#got " " #sample ": %.2f ulp at %a", worst, at);             \
  } while (0)

static void exponential_and_logarithm_near_their_zeros(void **unused) {
  (void)unused;
  WITHIN(2, special_expm1, expm1l, uniform(&state, -1, 1));
  WITHIN(2, special_expm1, expm1l, uniform(&state, -50, 700));
  WITHIN(1.5, special_expm1, expm1l, sized(&state, -300, 1));
  WITHIN(2.5, special_log1p, log1pl, uniform(&state, -0.999, 3));
  WITHIN(2.5, special_log1p, log1pl, sized(&state, -300, -0.01));
  assert_true(special_expm1(INFINITY) == INFINITY && special_expm1(-INFINITY) == -1);
  assert_true(special_log1p(-1) == -INFINITY && special_log1p(INFINITY) == INFINITY);
  assert_true(isnan(special_log1p(-1.5)) && isnan(special_expm1(NAN)));
}

/* Taylor's series where 1 + x would be rounded: -Euler's constant x + sum zeta(k) (-x)^k/k. */
static long double log_gamma_of_one_more(long double x) {
  static const long double zeta[] = {1.64493406684822643647L, 1.20205690315959428540L,
                                     1.08232323371113819152L, 1.03692775514336992633L,
                                     1.01734306198444913971L, 1.00834927738192282684L};
  if (x > 0.001L) return lgammal(1 + x);
  long double sum = -0.57721566490153286061L * x, power = -x;
  for (int k = 2; k < 8; k++)
    sum += zeta[k - 2] * (power *= -x) / k;
  return sum;
}

static long double gamma_of_one_more(long double x) {
  return tgammal(1 + x);
}

/* Whole x give factorials to the bit, as far as doubles hold them. */
static void gamma_function(void **unused) {
  (void)unused;
  WITHIN(4, special_log_gamma, log_gamma_of_one_more, fabs(sized(&state, -12, 0)));
  WITHIN(4, special_log_gamma, log_gamma_of_one_more, uniform(&state, 0, 41));
  WITHIN(8, special_gamma, gamma_of_one_more, uniform(&state, 0, 21));
  double factorial = 1;
  for (int n = 0; n <= 18; n++) {
    factorial *= n ? n : 1;
    assert_true(special_gamma(n) == factorial);
  }
  assert_true(special_gamma(171) == INFINITY && special_log_gamma(1e300) == INFINITY);
}

static long double normal_above(long double z) {
  return erfcl(z * sqrtl(0.5L)) / 2;
}

static void normal_distribution(void **unused) {
  (void)unused;
  WITHIN(1.5, special_normal_above, normal_above, uniform(&state, -9, 0));
  WITHIN(6, special_normal_above, normal_above, uniform(&state, 0, 9));
  WITHIN(6, special_normal_above, normal_above, uniform(&state, 9, 37));
  WITHIN(2.5, special_normal_above, normal_above, sized(&state, -20, 0));
  assert_true(special_normal_above(0) == 0.5);
  assert_true(special_normal_above(INFINITY) == 0 && special_normal_above(-INFINITY) == 1);
}

/* Whole turns more leave the bits as they are. */
static void cosine_of_turns(void **unused) {
  (void)unused;
  uint64_t state = 1;
  double worst = 0;
  for (int k = 0; k < SAMPLES; k++) {
    const double turn = uniform(&state, -0.5, 0.5);
    const long double exact = cosl(2 * acosl(-1) * (long double)turn);
    worst = fmax(worst, (double)fabsl((long double)special_cosine_of_turns(turn) - exact));
    const double coarse = rint(turn * 0x1p20) * 0x1p-20;
    assert_true(special_cosine_of_turns(coarse) == special_cosine_of_turns(coarse + 123456789));
    assert_true(special_cosine_of_turns(-turn) == special_cosine_of_turns(turn));
  }
  printf("  cosine of turns          %.2e\n", worst);
  assert_true(worst <= 3e-16);
  assert_true(special_cosine_of_turns(0.25) == 0 && special_cosine_of_turns(0) == 1);
}

static void assert_near(double got, double exact, double tolerance) {
  if (!(fabs(got - exact) <= tolerance)) fail_msg("%.17g, not %.17g", got, exact);
}

/* Of cos^(freedom - 1) from 0 to `angle`, by Simpson's rule. */
static long double cosine_power(long double angle, int freedom) {
  enum { PIECES = 4000 };
  long double sum = 0;
  for (int k = 0; k <= PIECES; k++)
    sum += (k % PIECES == 0 ? 1 : 2 + 2 * (k % 2)) * powl(cosl(angle * k / PIECES), freedom - 1);
  return sum * angle / (3 * PIECES);
}

/* Tables (Abramowitz and Stegun 1964, table 26.10) and a quadrature of the density in the angle
   whose tangent is t/sqrt(freedom); closed forms of 1, 2 and 4 degrees; the normal distribution. */
static void student_distribution(void **unused) {
  (void)unused;
  static const struct {
    int freedom;
    double inside, t;
  } known[] = {{3, 0.95, 3.182},  {5, 0.95, 2.571},  {10, 0.95, 2.228},
               {30, 0.99, 2.750}, {60, 0.95, 2.000}, {120, 0.9, 1.658}};
  for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
    const int freedom = known[k].freedom;
    const double t = special_student_quantile(known[k].inside, freedom);
    const long double part = cosine_power(atanl((long double)t / sqrtl(freedom)), freedom);
    assert_near(t, known[k].t, 5e-4);
    assert_near((double)(part / cosine_power(acosl(0), freedom)), known[k].inside, 1e-13);
  }
  for (double inside = 0.01; inside < 0.999; inside += 0.01) {
    const double cauchy = tan(acos(-1) * inside / 2);
    const double two = inside * sqrt(2 / (1 - inside * inside));
    const double t = special_student_quantile(inside, 4), w = 4 + t * t;
    assert_near(special_student_quantile(inside, 1) / cauchy, 1, 1e-12);
    assert_near(special_student_quantile(inside, 2) / two, 1, 1e-12);
    assert_near(t * (w + 2) / (w * sqrt(w)), inside, 1e-13);
  }
  const double normal = special_student_quantile(0.95, 1000000);
  assert_near(normal, 1.959963984540054, 4e-6);
  assert_true(special_student_quantile(0.95, 5000000000L) == normal);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(exponential_and_logarithm_near_their_zeros),
      cmocka_unit_test(gamma_function),
      cmocka_unit_test(normal_distribution),
      cmocka_unit_test(cosine_of_turns),
      cmocka_unit_test(student_distribution),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
