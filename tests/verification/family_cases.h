/* Cases of examples/ with laws of families, at a spacing of the caller's, against theory. */
#ifndef PERILAT_TESTS_FAMILY_CASES_H
#define PERILAT_TESTS_FAMILY_CASES_H

#include "tests/verification/case.h"

static inline void run_of(deck_case *c, const char *name, const char *const *overrides, int count) {
  assert_true(deck_case_run(c, name, overrides, count));
  assert_int_equal(deck_case_go(c), STEP_END);
}

static inline void is_within(const char *what, double value, double low, double high) {
  print_message("%s: %.6g\n", what, value);
  if (!(value >= low && value <= high))
    fail_msg("%s: %g is not in %g to %g", what, value, low, high);
}

/* --- elasticity ------------------------------------------------------------------------------- */

static inline void check_cube(const char *spacing) {
  deck_case c;
  run_of(&c, "examples/fcc_cube/cube.nml", &spacing, 1);
  const double strain = deck_case_last(&c, "strain");
  is_within("E/25 GPa", deck_case_last(&c, "stress") / strain / 25e9, 0.99, 1.01);
  is_within("nu", -deck_case_last(&c, "lateral") / strain, 0.185, 0.215);
  deck_case_close(&c);
}

/* --- waves ------------------------------------------------------------------------------------ */

/* Time of the pulse's centre of gravity. */
static inline double centre_of(const deck_case *c, const char *name) {
  const double *time, *v = deck_case_series(c, name);
  const long count = simulation_history(c->simulation, &time);
  double sum = 0, moment = 0;
  for (long k = 1; k < count; k++) {
    sum += v[k] * (time[k] - time[k - 1]);
    moment += v[k] * time[k] * (time[k] - time[k - 1]);
  }
  return moment / sum;
}

/* Error of the speed between the stations 0.4 m apart, against that of a bar of the lattice's own
   modulus. */
static inline double error_of_speed(const char *name, const char *const overrides[2], double E) {
  deck_case c;
  run_of(&c, name, overrides, 2);
  const double speed = 0.4 / (centre_of(&c, "far") - centre_of(&c, "near"));
  const double error = speed / sqrt(E / 2323) - 1;
  print_message("%s, %s: error of the speed %.4f\n", name, overrides[0], error);
  deck_case_close(&c);
  return error;
}

/* The free sides make the bar stiffer by a part that goes with the horizon over the height. */
static inline void check_pulses(const char *const coarse[2], const char *const fine[2],
                                double most) {
  static const struct {
    const char *deck;
    double E; /* Pa, that perilat announces for the lattice */
  } laws[] = {{"examples/wave_in_a_bar/pmb.nml", 25.57e9},
              {"examples/wave_in_a_bar/lps.nml", 25.52e9}};
  for (size_t k = 0; k < sizeof laws / sizeof *laws; k++) {
    const double first = error_of_speed(laws[k].deck, coarse, laws[k].E);
    const double second = error_of_speed(laws[k].deck, fine, laws[k].E);
    assert_true(second < most && second < 0.7 * first);
  }
}

/* --- cracks ----------------------------------------------------------------------------------- */

/* Time at which a fifth of the bonds at a station is broken. */
static inline double passes_at(const deck_case *c, const char *name) {
  const double *time, *broken = deck_case_series(c, name);
  const long count = simulation_history(c->simulation, &time);
  for (long k = 0; k < count; k++)
    if (broken[k] > 0.2) return time[k];
  fail_msg("the crack does not reach %s", name);
  return 0;
}

/* Between 0.4 and 1 of the Rayleigh speed, 0.93 c_s; a crack that leaves its plane by three rows
   breaks a fifth of the bonds there and more. */
static inline void check_crack(const char *const overrides[2]) {
  deck_case c;
  run_of(&c, "examples/running_crack/pmb.nml", overrides, 2);
  const double rayleigh = (0.862 + 1.14 / 3) / (4. / 3) * sqrt(27e9 / 2440);
  is_within("crack speed over Rayleigh's",
            0.04 / (passes_at(&c, "b85") - passes_at(&c, "b45")) / rayleigh, 0.4, 1);
  is_within("bonds broken above the crack", deck_case_last(&c, "above"), 0, 0.2);
  is_within("bonds broken below the crack", deck_case_last(&c, "below"), 0, 0.2);
  deck_case_close(&c);
}

static inline void check_beam(const char *spacing) {
  deck_case c;
  run_of(&c, "examples/notched_beam_3d/beam.nml", &spacing, 1);
  const double *load = deck_case_series(&c, "load");
  const double peak = load[largest_of(load, simulation_history(c.simulation, NULL))];
  is_within("peak, N", peak, 3500, 5500);
  is_within("load at the end over the peak", deck_case_last(&c, "load") / peak, 0, 0.5);
  is_within("energy of the crack over G_f times the ligament",
            deck_case_last(&c, "energy/dissipated_damage") / (80 * 50.8e-3 * 76.2e-3), 0.5, 1.3);
  deck_case_close(&c);
}

#endif
