/* Is a load that is held borne? Motions with known answers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "generator/study/held_load.h"

static void is_near(double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance))
    fail_msg("%.9g is not %.9g +- %.2g", value, expected, tolerance);
}

enum { SAMPLES = 1201 };

static held_load judge(double (*motion)(double t)) {
  double time[SAMPLES], u[SAMPLES];
  for (int k = 0; k < SAMPLES; k++) {
    time[k] = 3.0 * k / (SAMPLES - 1);
    u[k] = motion(time[k]);
  }
  return held_load_judge(time, u, SAMPLES, 1, 3, 0.05, 1); /* held from 1 to 3, middle 2 */
}

/* Swings on for ever. */
static double swing(double t) {
  return -0.01 * (1 + 0.2 * sin(40 * t));
}

/* Loaded until 1 it overshoots: what it was before the hold does not count. */
static double overshoot(double t) {
  return t < 1 ? 0.05 : 0.01;
}

static double creep(double t) {
  return 0.01 * (1 + 0.2 * t);
}

/* Comes to rest from a wide swing. */
static double settling(double t) {
  return 0.01 * (1 + exp(-t) * sin(40 * t));
}

static double fall(double t) {
  return t < 1 ? 0.001 : 0.001 + 0.01 * (t - 1) * (t - 1);
}

static double far(double t) {
  return t < 0.5 ? 1.5 : 0.5;
}

static double bad(double t) {
  return t > 2.5 ? NAN : 0.01;
}

static void verdicts(void **state) {
  (void)state;
  assert_int_equal(judge(swing).verdict, HELD_BORNE);
  assert_int_equal(judge(overshoot).verdict, HELD_BORNE);
  assert_int_equal(judge(creep).verdict, HELD_COLLAPSED); /* 0.016 against 0.014 */
  assert_int_equal(judge(settling).verdict, HELD_UNDECIDED);
  assert_int_equal(judge(fall).verdict, HELD_COLLAPSED); /* 0.041 against 0.011 */
  assert_int_equal(judge(far).verdict, HELD_COLLAPSED);
  assert_int_equal(judge(bad).verdict, HELD_COLLAPSED);
  is_near(judge(creep).first, 0.014, 1e-6);
  is_near(judge(creep).second, 0.016, 1e-6);
}

/* A run that ends before its hold says nothing, unless it has passed the limit. */
static void cut_short(void **state) {
  (void)state;
  const double time[] = {0, 0.5, 1, 1.5}, u[] = {0, 0.01, 0.01, 0.01}, away[] = {0, 0.1, 0.5, 1.2};
  assert_int_equal(held_load_judge(time, u, 4, 1, 3, 0.05, 1).verdict, HELD_CUT);
  assert_int_equal(held_load_judge(time, u, 0, 1, 3, 0.05, 1).verdict, HELD_CUT);
  assert_int_equal(held_load_judge(time, u, 2, 1, 3, 0.05, 1).verdict, HELD_CUT);
  assert_int_equal(held_load_judge(time, away, 4, 1, 3, 0.05, 1).verdict, HELD_COLLAPSED);
  assert_int_equal(held_load_judge(time, u, 4, 0.5, 1.5, 0.05, 1).verdict, HELD_BORNE);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(verdicts), cmocka_unit_test(cut_short)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
