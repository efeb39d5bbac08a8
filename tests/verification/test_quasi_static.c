/* The quasi-static run of the prism in tension beside dynamic ones that pull it apart within 80 and
   160 periods of its fundamental vibration. What tells them apart is the speed: dampers on the
   particles, dampers in the bonds, inertia where the crack runs. So half the speed must be half as
   far away, and no speed, which is twice the slower run less the faster, is where the quasi-static
   run is. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"

static const double far_enough = 131e-6; /* m: before the last of the crack gives way */

typedef struct pull { /* until that opening of the ends */
  deck_case run;
  const double *opening, *load;
  long samples;
} pull;

static void pull_apart(pull *p, const char *deck_name, const char *const *overrides, int count) {
  step_status status = STEP_OK;
  assert_true(deck_case_run(&p->run, deck_name, overrides, count));
  p->opening = deck_case_series(&p->run, "displacement");
  p->load = deck_case_series(&p->run, "load");
  do {
    assert_int_equal(status, STEP_OK);
    status = simulation_advance(p->run.simulation, 200, NULL);
    p->samples = simulation_history(p->run.simulation, NULL);
  } while (p->opening[p->samples - 1] < far_enough);
}

/* N at an opening in m, on the straight line between two samples. */
static double load_at(const pull *p, double opening) {
  long k = 1;
  while (k < p->samples - 1 && p->opening[k] < opening)
    k++;
  const double part = (opening - p->opening[k - 1]) / (p->opening[k] - p->opening[k - 1]);
  return p->load[k - 1] + part * (p->load[k] - p->load[k - 1]);
}

static double peak_of(const pull *p) {
  return p->load[largest_of(p->load, p->samples)];
}

/* Opening at which less than 0.6 of the peak is left. */
static double fall_of(const pull *p) {
  long k = largest_of(p->load, p->samples);
  while (p->load[k] > 0.6 * peak_of(p))
    k++;
  return p->opening[k];
}

static pull fast, slow, still;

static int run_all(void **state) {
  (void)state;
  static const char *const once[] = {"simulation.threads=1"};
  static const char *const half[] = {"simulation.threads=1", "drive.rise=67.2 ms",
                                     "simulation.end_time=84 ms"};
  pull_apart(&fast, "examples/tension/rot0.nml", once, 1);
  pull_apart(&slow, "examples/tension/rot0.nml", half, 3);
  pull_apart(&still, "examples/tension/rot0_quasi_static.nml", once, 1);
  return 0;
}

static int close_all(void **state) {
  (void)state;
  deck_case_close(&fast.run);
  deck_case_close(&slow.run);
  deck_case_close(&still.run);
  return 0;
}

/* What the quasi-static load at an opening is less than the others', and than theirs at no speed.
   */
typedef struct distance {
  double from_fast, from_slow, from_limit;
} distance;

static distance distance_at(double opening) {
  const double f = load_at(&fast, opening), s = load_at(&slow, opening),
               q = load_at(&still, opening);
  const distance d = {1 - q / f, 1 - q / s, 1 - q / (2 * s - f)};
  print_message("%5.1f um: %7.1f N, dynamic %7.1f and %7.1f N: %+.3f %%, %+.3f %%, at no speed "
                "%+.3f %%\n",
                1e6 * opening, q, f, s, -100 * d.from_fast, -100 * d.from_slow,
                -100 * d.from_limit);
  return d;
}

/* The ends differ by the sum of what is left on 543 particles. With a square sum of 0.1 % of that
   of the reactions, which the 15 particles of the inner row of either end carry nearly alone, it is
   at most 0.1 % sqrt(2*543/15) of the load; a fifth more, because they do not carry evenly. */
static void every_increment_came_to_rest(void **state) {
  (void)state;
  long unbalanced;
  const long done = simulation_increments(still.run.simulation, &unbalanced);
  const double *left = deck_case_series(&still.run, "relaxation_unbalance");
  const double *top = deck_case_series(&still.run, "top"),
               *bottom = deck_case_series(&still.run, "bottom");
  assert_true(done > 300);
  assert_int_equal(unbalanced, 0);
  for (long k = 1; k <= done; k++) {
    assert_true(left[k] <= 1e-3);
    assert_true(fabs(top[k] - bottom[k]) <= 1.2e-3 * sqrt(2 * 543.0 / 15) * top[k]);
  }
}

/* 0.5 %: the dampers on the particles, whose drag at mid-height is half of what the ends differ by,
   take 0.2 to 0.5 %. 0.02 %: the tolerance of the run's increments is 0.1 % of the reactions in the
   square mean. */
static void the_elastic_branch(void **state) {
  (void)state;
  for (double opening = 6e-6; opening < 27e-6; opening += 2e-6) {
    const distance d = distance_at(opening);
    assert_true(fabs(d.from_fast) < 0.005);
    assert_true(fabs(d.from_slow) < 0.6 * fabs(d.from_fast));
    assert_true(fabs(d.from_limit) < 2e-4);
  }
}

/* 1 %: rows of particles begin to soften one after the other, and the load has a small tooth for
   each. */
static void the_peak(void **state) {
  (void)state;
  print_message("peaks %.0f, %.0f, %.0f N\n", peak_of(&fast), peak_of(&slow), peak_of(&still));
  assert_true(fabs(1 - peak_of(&still) / peak_of(&fast)) < 0.01);
  assert_true(fabs(1 - peak_of(&still) / (2 * peak_of(&slow) - peak_of(&fast))) < 0.005);
}

/* The body sets free more than the crack takes: the load falls at one opening (a jump, at rest).
   Inertia and dampers hold it up, the less the slower. Within 1280 periods, instead of 80, it falls
   at 32.4 um. */
static void the_fall(void **state) {
  (void)state;
  const double f = fall_of(&fast), s = fall_of(&slow), q = fall_of(&still);
  print_message("the load falls at %.2f, %.2f, %.2f um\n", 1e6 * f, 1e6 * s, 1e6 * q);
  assert_true(q < s && s < f);
  assert_true(q > 31.5e-6 && q < 33e-6);
}

/* The second branch of the law. 3 %: damping is a larger part of a smaller load. 1 % at no speed:
   how far each row was damaged in the fall, which was a jump, stays with it. */
static void the_softening_branch(void **state) {
  (void)state;
  for (double opening = 50e-6; opening < 129e-6; opening += 10e-6) {
    const distance d = distance_at(opening);
    assert_true(fabs(d.from_fast) < 0.03);
    assert_true(fabs(d.from_slow) < 0.8 * fabs(d.from_fast));
    assert_true(fabs(d.from_limit) < 0.01);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_increment_came_to_rest),
      cmocka_unit_test(the_elastic_branch),
      cmocka_unit_test(the_peak),
      cmocka_unit_test(the_fall),
      cmocka_unit_test(the_softening_branch),
  };
  return cmocka_run_group_tests(tests, run_all, close_all);
}
