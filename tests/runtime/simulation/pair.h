/* Two particles and the bar between them against closed forms: the error of a run falls with the
   square of its step. */
#ifndef PERILAT_TESTS_PAIR_H
#define PERILAT_TESTS_PAIR_H

#include "tests/runtime/small_run.h"

#define SPACING   0.01
#define THICKNESS 0.1

/* Two particles in a row, the left one at x = 0; a bar between them. */
#define PAIR                                                                                       \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"                      \
  "&material lattice = 'c' model = 'm' /\n"                                                        \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, -0.001 size = 0.01, 0.002 /\n"              \
  "&region name = 'left' shape = 'point' at = 0, 0 /\n"                                            \
  "&region name = 'right' shape = 'point' at = 0.01, 0 /\n"
#define FIXED "&support region = 'left' fix = 'x' /\n"

enum { STEPS = 160 }; /* of the coarsest run, over a little more than one period */

static inline double mass(void) {
  return 2323 * sqrt(3) / 2 * SPACING * SPACING * THICKNESS;
}

static inline double stiffness(void) {
  return 30e9 * THICKNESS / (sqrt(3) * (1 - 0.2));
}

static inline double frequency(void) {
  return sqrt(stiffness() / mass());
}

static inline double end_time(void) {
  return 7 / frequency();
}

/* So many of its steps, s. */
static inline double step_of(double steps) {
  return steps * end_time() / STEPS;
}

/* What the right particle, or another series, should be at time t after what begins at `start`. */
typedef struct motion {
  const char *groups; /* a format: start, in s */
  double start;       /* in coarse steps */
  const char *series;
  double (*exact)(double t, double start);
  double size;
} motion;

static inline small_run open_run(const motion *m, int steps) {
  char groups[2048], text[4096];
  const double start = step_of(m->start);
  snprintf(groups, sizeof groups, m->groups, start, start, start);
  snprintf(text, sizeof text,
           "&simulation end_time = %.17g step = %.17g /\n" PAIR "%s"
           "&monitor name = 'u' kind = 'displacement' region = 'right' component = 'x' /\n"
           "&monitor name = 'v' kind = 'velocity' region = 'right' component = 'x' /\n"
           "&monitor name = 'r' kind = 'reaction' region = 'left' component = 'x' /\n"
           "&output frames = 0 sample = %.17g /\n",
           end_time(), end_time() / steps, groups, end_time() / steps);
  small_run r;
  small_open(&r, &elastic_bar, text);
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  return r;
}

/* Largest error over the run, in parts of the motion's size. */
static inline double error_of(const motion *m, int steps) {
  small_run r = open_run(m, steps);
  const double start = step_of(m->start), *time, *values;
  assert_int_equal(small_go(&r), STEP_END);
  const long samples = simulation_history(r.simulation, &time);
  assert_int_equal(samples, steps + 1);
  simulation_series(r.simulation, small_series(&r, m->series), NULL, &values);
  /* velocities and reactions half a step from a jump are means over it */
  const double near = (*m->series == 'u' ? 1e-6 : 0.5001) * time[1];
  double most = 0;
  for (long k = 0; k < samples; k++) {
    if (start > 0 && fabs(time[k] - start) < near) continue;
    const double error = fabs(values[k] - m->exact(time[k], start));
    most = error <= most ? most : error;
  }
  small_close(&r);
  return most / m->size;
}

static inline void falls_with_the_square(const motion *m) {
  const double coarse = error_of(m, STEPS), fine = error_of(m, 4 * STEPS);
  const double order = log2(coarse / fine) / 2;
  print_message("%-2s from %5.2f: error %.1e, %.1e, order %.2f\n", m->series, m->start, coarse,
                fine, order);
  assert_true(coarse < 0.02);
  assert_true(fine < 1e-12 || (order > 1.6 && order < 2.4));
}

/* Reactions after each quarter of a quasi-static run, in parts of 100 N. */
static inline void expect_quarters(const char *load, const double expected[5]) {
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n&relaxation increments = 4 tolerance = 1e-9 /\n" PAIR FIXED
           "%s&monitor name = 'r' kind = 'reaction' region = 'left' component = 'x' scale = -1 /\n"
           "&output frames = 0 /\n",
           load);
  small_run r;
  small_open(&r, &elastic_bar, text);
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  assert_int_equal(small_go(&r), STEP_END);
  const double *held;
  simulation_series(r.simulation, small_series(&r, "r"), NULL, &held);
  for (int k = 0; k < 5; k++)
    if (!(fabs(held[k] / 100 - expected[k]) <= 1e-6))
      fail_msg("%s: %g instead of %g after %d", load, held[k] / 100, expected[k], k);
  small_close(&r);
}

#endif
