/* Loads that end: a force that is gone, a drive that lets go. Errors fall with the square of the
   step whenever that is, and the ledger closes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/sweep.h"
#include "tests/runtime/hand_over.h"
#include "tests/runtime/simulation/pair.h"
#include "tests/runtime/simulation/same_runs.h"

/* In coarse steps; in fine ones, a quarter as long, as far from the nearest instant. */
static const double ends[] = {40, 40.2, 40 + 1 / 3.0, 40 + 2 / 3.0, 40.8};
enum { END_COUNT = sizeof ends / sizeof *ends };

/* --- forces ----------------------------------------------------------------------------------- */

/* 100 N from 0 to `end`. */
static double pushed_until(double t, double end) {
  const double u = 100 / stiffness(), w = frequency();
  return u * ((t < end ? 1 : cos(w * (t - end))) - cos(w * t));
}

static double pushed_velocity_until(double t, double end) {
  const double u = 100 / stiffness(), w = frequency();
  return u * w * (sin(w * t) - (t < end ? 0 : sin(w * (t - end))));
}

static double pushed_support_until(double t, double end) {
  return -stiffness() * pushed_until(t, end);
}

/* A weight of 10 m/s^2. */
static double weighed_until(double t, double end) {
  return pushed_until(t, end) * mass() * 10 / 100;
}

/* It grows without end, 100 N in the time of the run. */
static double ramped_until(double t, double end) {
  const double w = frequency(), a = 100 / stiffness() / end_time(), s = t - end;
  const double growing = a * (t - sin(w * t) / w);
  return t < end ? growing : growing - a * (end * (1 - cos(w * s)) + s - sin(w * s) / w);
}

static void a_force_may_end_at_any_time(void **state) {
  (void)state;
  const double u = 2 * 100 / stiffness();
  char ramp[512];
  snprintf(ramp, sizeof ramp,
           FIXED "&force region = 'right' component = 'x' total = 100 history = 'ramp' rise = "
                 "%.17g end = %%.17g /\n",
           end_time());
#define PUSH FIXED "&force region = 'right' component = 'x' total = 100 end = %.17g /\n"
  for (int k = 0; k < END_COUNT; k++) {
    const motion all[] = {
        {PUSH, ends[k], "u", pushed_until, u},
        {PUSH, ends[k], "v", pushed_velocity_until, u * frequency() / 2},
        {PUSH, ends[k], "r", pushed_support_until, u * stiffness()},
        {FIXED "&gravity acceleration = 10, 0 end = %.17g /\n", ends[k], "u", weighed_until,
         u * mass() * 10 / 100},
        {ramp, ends[k], "u", ramped_until, u / 4},
    };
    for (size_t n = 0; n < sizeof all / sizeof *all; n++)
      falls_with_the_square(&all[n]);
  }
}

/* A pulse within half a step is an impulse of force times time, on a particle that is free. */
static void a_pulse_within_a_step_counts_in_full(void **state) {
  (void)state;
  char groups[512];
  for (int k = 0; k < 6; k++) {
    const double start = step_of(40 + 0.2 * k), end = start + step_of(0.13);
    snprintf(groups, sizeof groups,
             "&force region = 'left' component = 'x' total = 100 start = %.17g end = %.17g /\n"
             "&force region = 'right' component = 'x' total = 100 start = %.17g end = %.17g /\n"
             "&drive region = 'left' component = 'x' velocity = 1 start = 1 /\n",
             start, end, start, end);
    small_run r = open_run(&(motion){groups, 0, "u", NULL, 1}, STEPS);
    const sweep *w = simulation_state(r.simulation, 0);
    assert_int_equal(small_go(&r), STEP_END);
    const double v = w->body->velocity[0][w->body->lattice->particle_site[1]];
    assert_true(fabs(v / (100 * step_of(0.13) / mass()) - 1) < 1e-9);
    small_close(&r);
  }
}

/* --- drives ----------------------------------------------------------------------------------- */

/* A spring's particle that is let go at `end` with displacement U and velocity V. */
static double let_go(double t, double end, double U, double V) {
  const double w = frequency(), s = t - end;
  return U * cos(w * s) + V / w * sin(w * s);
}

static double towed(double t, double end) {
  return t < end ? t : let_go(t, end, end, 1);
}

static double towed_support(double t, double end) {
  return -stiffness() * towed(t, end);
}

static double towed_velocity(double t, double end) {
  const double w = frequency(), s = t - end;
  return t < end ? 1 : cos(w * s) - w * end * sin(w * s);
}

/* Velocity t/end_time. */
static double hurried(double t, double end) {
  const double a = 1 / end_time();
  return t < end ? a * t * t / 2 : let_go(t, end, a * end * end / 2, a * end);
}

static double along_cosine(double t, double end) {
  const double q = acos(-1) / (2 * end_time());
  return 1e-5 * (t < end ? (1 - cos(q * t)) / 2
                         : let_go(t, end, (1 - cos(q * end)) / 2, q * sin(q * end) / 2));
}

/* A micrometer in the time until it ends. */
static double placed(double t, double end) {
  return t < end ? 1e-6 * t / end : let_go(t, end, 1e-6, 1e-6 / end);
}

static double towed_damped(double t, double end) {
  const double rate = 3e4, d = rate / 2, w = sqrt(frequency() * frequency() - d * d), s = t - end;
  if (t < end) return t;
  return exp(-d * s) * (end * cos(w * s) + (1 + d * end) / w * sin(w * s));
}

#define RIGHT "&drive region = 'right' component = 'x' "
#define TOWED FIXED RIGHT "velocity = 1 end = %.17g /\n"

static void a_drive_lets_go_at_any_time(void **state) {
  (void)state;
  const double u = step_of(40);
  char hurrying[512], cosine[512];
  snprintf(hurrying, sizeof hurrying, FIXED RIGHT "velocity = 2 rise = %.17g end = %%.17g /\n",
           2 * end_time());
  snprintf(cosine, sizeof cosine,
           FIXED RIGHT "displacement = 1e-5 history = 'cosine' rise = %.17g end = %%.17g /\n",
           2 * end_time());
  for (int k = 0; k < END_COUNT; k++) {
    const motion all[] = {
        {TOWED, ends[k], "u", towed, u},
        {TOWED, ends[k], "v", towed_velocity, 2},
        {TOWED, ends[k], "r", towed_support, u * stiffness()},
        {TOWED "&damping rate = 3e4 /\n", ends[k], "u", towed_damped, u},
        {hurrying, ends[k], "u", hurried, u * u / 2 / end_time()},
        {cosine, ends[k], "u", along_cosine, 4e-7},
        {FIXED RIGHT "displacement = 1e-6 rise = %.17g end = %.17g /\n", ends[k], "u", placed,
         1e-6},
        {FIXED RIGHT "displacement = 1e-6 times = 0, %.17g values = 0, 1 end = %.17g /\n", ends[k],
         "u", placed, 1e-6},
    };
    for (size_t n = 0; n < sizeof all / sizeof *all; n++)
      falls_with_the_square(&all[n]);
  }
}

static double thrown(double t, double end) {
  (void)end;
  return 3 * t;
}

/* Both particles leave the drive as it moves them, and nothing acts on them. */
static void what_flies_on_flies_exactly(void **state) {
  (void)state;
  for (int k = 0; k < END_COUNT; k++) {
    const motion m = {RIGHT "velocity = 3 end = %.17g /\n"
                            "&drive region = 'left' component = 'x' velocity = 3 end = %.17g /\n",
                      ends[k], "u", thrown, end_time()};
    assert_true(error_of(&m, STEPS) < 1e-12);
  }
}

/* Velocity a t until the end: the particles fly with a t_e. */
static void a_drive_that_hurries_throws_with_its_last_velocity(void **state) {
  (void)state;
  for (int k = 0; k < END_COUNT; k++) {
    char groups[512];
    snprintf(groups, sizeof groups,
             RIGHT "velocity = 1 history = 'ramp' rise = %.17g end = %%.17g /\n"
                   "&drive region = 'left' component = 'x' velocity = 1 history = 'ramp' rise = "
                   "%.17g end = %%.17g /\n",
             end_time(), end_time());
    small_run r = open_run(&(motion){groups, ends[k], "u", NULL, 1}, STEPS);
    const sweep *w = simulation_state(r.simulation, 0);
    assert_int_equal(small_go(&r), STEP_END);
    for (int p = 0; p < 2; p++) {
      const double v = w->body->velocity[0][w->body->lattice->particle_site[p]];
      assert_true(fabs(v / (ends[k] / STEPS) - 1) < 1e-10);
    }
    small_close(&r);
  }
}

/* --- what is booked --------------------------------------------------------------------------- */

/* Everything at once: kinetic and stored energy, damping, forces on what lets go, weight. */
static void the_ledger_closes(void **state) {
  (void)state;
  for (int k = 0; k < END_COUNT; k++) {
    const motion m = {FIXED RIGHT
                      "velocity = 1 start = 1e-7 end = %.17g /\n"
                      "&force region = 'right' component = 'x' total = 3e5 end = %.17g /\n"
                      "&force region = 'right' component = 'x' total = 2e5 start = %.17g /\n"
                      "&gravity acceleration = 1e5, 0 /\n&damping rate = 3e4 /\n"
                      "&monitor name = 'driver' kind = 'reaction' region = 'right' component = "
                      "'x' /\n",
                      ends[k], "u", NULL, 1};
    small_run r = open_run(&m, STEPS);
    const double *time, *driver;
    assert_int_equal(small_go(&r), STEP_END);
    const double most = small_largest(&r, "energy/external");
    assert_true(most > 0.5 * mass());
    assert_true(small_largest(&r, "energy/imbalance") < 1e-12 * most);
    const long samples = simulation_history(r.simulation, &time);
    simulation_series(r.simulation, small_series(&r, "driver"), NULL, &driver);
    for (long n = 0; n < samples; n++)
      assert_int_equal(driver[n] != 0, time[n] < step_of(ends[k]) + 0.4999 * time[1] && n > 0);
    small_close(&r);
  }
}

/* Resumed in the step before it lets go, in that one, and after. */
static void a_run_goes_on_as_if_it_had_not_stopped(void **state) {
  (void)state;
  const motion m = {TOWED, 40.3, "u", NULL, 1};
  small_run whole = open_run(&m, STEPS);
  assert_int_equal(small_go(&whole), STEP_END);
  for (int stop = 39; stop <= 42; stop++) {
    small_run first = open_run(&m, STEPS), second = open_run(&m, STEPS);
    hand_over(first.simulation, stop, second.simulation);
    assert_int_equal(small_go(&second), STEP_END);
    same_runs(&whole, &second);
    small_close(&first);
    small_close(&second);
  }
  small_close(&whole);
}

/* --- quasi-static runs ------------------------------------------------------------------------ */

/* What ends with an increment is there at its end. */
static void loads_end_with_increments(void **state) {
  (void)state;
  char drive[512];
#define FORCE "&force region = 'right' component = 'x' total = 100 "
  expect_quarters(FORCE "end = 0.5 /\n", (double[]){0, 0.5, 1, 0, 0});
  expect_quarters(FORCE "history = 'constant' end = 0.5 /\n", (double[]){0, 1, 1, 0, 0});
  expect_quarters(FORCE "history = 'constant' end = 0.6 /\n", (double[]){0, 1, 1, 0, 0});
  expect_quarters(FORCE "history = 'constant' start = 0.25 end = 0.75 /\n",
                  (double[]){0, 0, 1, 1, 0});
  snprintf(drive, sizeof drive, RIGHT "displacement = %.17g end = 0.5 /\n", 100 / stiffness());
  expect_quarters(drive, (double[]){0, 0.5, 1, 0, 0});
  snprintf(drive, sizeof drive, RIGHT "velocity = %.17g start = 0.25 end = 0.75 /\n",
           200 / stiffness());
  expect_quarters(drive, (double[]){0, 0, 0.5, 1, 0});
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_force_may_end_at_any_time),
      cmocka_unit_test(a_pulse_within_a_step_counts_in_full),
      cmocka_unit_test(a_drive_lets_go_at_any_time),
      cmocka_unit_test(what_flies_on_flies_exactly),
      cmocka_unit_test(a_drive_that_hurries_throws_with_its_last_velocity),
      cmocka_unit_test(the_ledger_closes),
      cmocka_unit_test(a_run_goes_on_as_if_it_had_not_stopped),
      cmocka_unit_test(loads_end_with_increments),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
