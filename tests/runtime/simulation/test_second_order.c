/* Loads in time against closed forms: the error of a run falls with the square of its step,
   whenever a load begins. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/sweep.h"
#include "tests/runtime/simulation/pair_motions.h"

/* --- forces ----------------------------------------------------------------------------------- */

/* The same by two forces on one particle. */
#define TWO_PUSH                                                                                   \
  FIXED "&force region = 'right' component = 'x' force = 60 start = %.17g /\n"                     \
        "&force region = 'right' component = 'x' force = 40 start = %.17g /\n"

static void a_force_may_begin_at_any_time(void **state) {
  (void)state;
  static const double starts[] = {0, 0.25, 40, 40.3, 40.5, 40.9};
  const double u = 2 * force / stiffness();
  for (size_t k = 0; k < sizeof starts / sizeof *starts; k++) {
    const motion all[] = {
        {PUSH, starts[k], "u", pushed, u},
        {PUSH, starts[k], "v", pushed_velocity, u * frequency() / 2},
        {PUSH, starts[k], "r", pushed_support, u * stiffness()},
        {PUSH "&damping rate = 3e4 /\n", starts[k], "u", pushed_damped, u},
        {TWO_PUSH, starts[k], "v", pushed_velocity, u * frequency() / 2},
    };
    for (size_t n = 0; n < sizeof all / sizeof *all; n++)
      falls_with_the_square(&all[n]);
  }
}

/* A table that begins with a jump and goes on. */
static double pushed_by_table(double t, double start) {
  const double w = frequency(), s = t - start, slope = -0.5 / end_time();
  return t < start ? 0 : force / stiffness() * (1 - cos(w * s) + slope * (s - sin(w * s) / w));
}

static void a_table_may_begin_with_a_jump(void **state) {
  (void)state;
  char groups[512];
  snprintf(groups, sizeof groups,
           FIXED "&force region = 'right' component = 'x' total = 100 start = %%.17g times = 0, "
                 "%.17g values = 1, 0.5 /\n",
           end_time());
  for (int k = 0; k < 3; k++)
    falls_with_the_square(
        &(motion){groups, 40 + 0.4 * k, "u", pushed_by_table, 2 * force / stiffness()});
}

/* --- gravity, velocities, damping ------------------------------------------------------------- */

/* 0.1 s of 10 m/s^2 is half a meter a second more, and a way of 5 cm. */
static void a_body_falls_five_centimetres_in_one_step(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &elastic_bar,
             "&simulation end_time = 10e-7 step = 1e-7 /\n" PAIR
             "&gravity acceleration = 0, -10 /\n"
             "&monitor name = 'fall' kind = 'displacement' region = 'right' component = 'y' /\n"
             "&monitor name = 'speed' kind = 'velocity' region = 'right' component = 'y' /\n"
             "&output frames = 0 sample = 1e-7 /\n");
  assert_non_null(r.simulation);
  assert_int_equal(small_go(&r), STEP_END);
  const double *time, *fall, *speed;
  const long samples = simulation_history(r.simulation, &time);
  simulation_series(r.simulation, small_series(&r, "fall"), NULL, &fall);
  simulation_series(r.simulation, small_series(&r, "speed"), NULL, &speed);
  for (long k = 0; k < samples; k++) {
    assert_true(fabs(fall[k] + 5 * time[k] * time[k]) <= 1e-12 * 5e-12);
    assert_true(fabs(speed[k] + 10 * time[k]) <= 1e-12 * 1e-5);
  }
  small_close(&r);
}

static double fallen_damped(double t, double start) {
  const double d = rate / 2, w = sqrt(frequency() * frequency() - d * d), since = t - start;
  const double part = exp(-d * since) * (cos(w * since) + d / w * sin(w * since));
  return t < start ? 0 : 10 / (frequency() * frequency()) * (1 - part);
}

static void gravity_may_begin_at_any_time(void **state) {
  (void)state;
  static const double starts[] = {0, 40, 40.3, 40.8};
  const double u = 20 / (frequency() * frequency());
  for (size_t k = 0; k < sizeof starts / sizeof *starts; k++) {
    falls_with_the_square(&(motion){WEIGHT, starts[k], "u", fallen, u});
    falls_with_the_square(
        &(motion){WEIGHT "&damping rate = 3e4 /\n", starts[k], "u", fallen_damped, u});
  }
}

static double thrown(double t, double start) {
  (void)start;
  const double d = rate / 2, w = sqrt(frequency() * frequency() - d * d);
  return exp(-d * t) * sin(w * t) / w;
}

static double thrown_freely(double t, double start) {
  (void)start;
  return sin(frequency() * t) / frequency();
}

static double speed_thrown(double t, double start) {
  (void)start;
  return cos(frequency() * t);
}

/* Freely until the damping begins. */
static double damped_late(double t, double start) {
  const double w0 = frequency(), d = rate / 2, w = sqrt(w0 * w0 - d * d), s = t - start;
  const double u = sin(w0 * start) / w0, v = cos(w0 * start);
  if (s < 0) return thrown_freely(t, 0);
  return exp(-d * s) * (u * cos(w * s) + (v + d * u) / w * sin(w * s));
}

/* Damped until then. */
static double damped_early(double t, double start) {
  const double w0 = frequency(), d = rate / 2, w = sqrt(w0 * w0 - d * d), s = t - start;
  if (s < 0) return thrown(t, 0);
  const double u = thrown(start, 0), v = exp(-d * start) * cos(w * start) - d * u;
  return u * cos(w0 * s) + v / w0 * sin(w0 * s);
}

#define THROWN FIXED "&initial_velocity region = 'right' component = 'x' value = 1 /\n"

static void damping_and_velocities_at_the_start(void **state) {
  (void)state;
  const double u = 1 / frequency();
  falls_with_the_square(&(motion){THROWN, 0, "u", thrown_freely, u});
  falls_with_the_square(&(motion){THROWN, 0, "v", speed_thrown, 1});
  falls_with_the_square(&(motion){THROWN "&damping rate = 3e4 /\n", 0, "u", thrown, u});
  for (int k = 0; k < 4; k++) {
    const double start = 40 + 0.3 * k;
    falls_with_the_square(
        &(motion){THROWN "&damping rate = 3e4 from = %.17g /\n", start, "u", damped_late, u});
    falls_with_the_square(
        &(motion){THROWN "&damping rate = 3e4 until = %.17g /\n", start, "u", damped_early, u});
  }
}

/* Nothing is dissipated at the start, then the drag's power, rate m v^2. */
static void damping_takes_what_its_drag_does(void **state) {
  (void)state;
  const motion m = {"&initial_velocity region = 'left' component = 'x' value = 1 /\n"
                    "&initial_velocity region = 'right' component = 'x' value = 1 /\n"
                    "&drive region = 'left' component = 'x' velocity = 1 start = %.17g /\n"
                    "&damping rate = 3e4 /\n",
                    2 * STEPS, "u", NULL, 1}; /* long after the end */
  small_run r = open_run(&m, STEPS);
  const double *time, *taken;
  assert_int_equal(small_go(&r), STEP_END);
  const long samples = simulation_history(r.simulation, &time);
  simulation_series(r.simulation, small_series(&r, "energy/dissipated_damping"), NULL, &taken);
  assert_true(taken[0] == 0);
  for (long k = 0; k < samples; k++) /* of both, to the order of the steps */
    assert_true(fabs(taken[k] - mass() * (1 - exp(-2 * rate * time[k]))) < 1e-4 * mass());
  small_close(&r);
}

/* --- drives ----------------------------------------------------------------------------------- */

static double dragged(double t, double start) {
  const double w = frequency(), s = t - start;
  return s < 0 ? 0 : s - sin(w * s) / w;
}

/* The drive's own particle does not accelerate once it moves: it carries the spring alone, from 0
   on. */
static double drag(double t, double start) {
  const double w = frequency(), s = t - start;
  return s < 0 ? 0 : stiffness() * sin(w * s) / w;
}

static double shoved(double t, double start) {
  const double w = frequency(), s = t - start, a = 1 / end_time();
  return s < 0 ? 0 : a * (s * s / 2 - (1 - cos(w * s)) / (w * w));
}

/* Spring and inertia of a particle that accelerates evenly. */
static double shove(double t, double start) {
  const double w = frequency(), s = t - start, a = 1 / end_time();
  return s < 0 ? 0 : stiffness() * a * (1 - cos(w * s)) / (w * w) + mass() * a;
}

static void a_drive_may_begin_at_any_time(void **state) {
  (void)state;
  static const double starts[] = {0, 0.25, 40, 40.3, 40.5, 40.9};
  const double w = frequency();
#define DRAG "&drive region = 'left' component = 'x' velocity = 1 start = %.17g /\n"
  char shoving[512], placing[512];
  snprintf(shoving, sizeof shoving,
           "&drive region = 'left' component = 'x' velocity = 2 start = %%.17g rise = %.17g /\n",
           2 * end_time());
  snprintf(
      placing, sizeof placing,
      "&drive region = 'left' component = 'x' displacement = %.17g start = %%.17g rise = %.17g /\n",
      2 * end_time(), 2 * end_time());
  for (size_t k = 0; k < sizeof starts / sizeof *starts; k++) {
    const motion all[] = {
        {DRAG, starts[k], "u", dragged, 1 / w},
        {DRAG, starts[k], "r", drag, stiffness() / w},
        {placing, starts[k], "u", dragged, 1 / w},
        {placing, starts[k], "r", drag, stiffness() / w},
        {shoving, starts[k], "u", shoved, 1 / (w * w * end_time())},
        {shoving, starts[k], "r", shove, mass() / end_time()},
    };
    for (size_t n = 0; n < sizeof all / sizeof *all; n++)
      falls_with_the_square(&all[n]);
  }
}

/* A drive takes up a particle that flies: its way is counted from where that is at the start. */
static double caught(double t, double start) {
  return t < start ? t : start + 3 * (t - start);
}

static void a_flying_particle_is_caught_where_it_is(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    const motion m = {"&initial_velocity region = 'left' component = 'x' value = 1 /\n"
                      "&initial_velocity region = 'right' component = 'x' value = 1 /\n"
                      "&drive region = 'right' component = 'x' velocity = 3 start = %.17g /\n"
                      "&drive region = 'left' component = 'x' velocity = 3 start = %.17g /\n",
                      40 + 0.4 * k, "u", caught, end_time()};
    assert_true(error_of(&m, STEPS) < 1e-12);
  }
}

/* The impulse of a drive that begins gives its particle half m v^2; the ledger closes. */
static void an_impulse_does_work(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    const motion m = {DRAG "&damping rate = 3e4 /\n", 0.4 * k, "r", drag, 1};
    small_run r = open_run(&m, STEPS);
    assert_int_equal(small_go(&r), STEP_END);
    const double *external;
    simulation_series(r.simulation, small_series(&r, "energy/external"), NULL, &external);
    const double half = 0.5 * mass();
    assert_true(fabs(external[k ? 2 : 1] / half - 1) < 0.1);
    assert_true(small_largest(&r, "energy/imbalance") < 1e-12 * half);
    small_close(&r);
  }
}

/* n dt may be a little before or after a start that is written in decimals. */
static void rounding_does_not_make_an_impulse_a_reaction(void **state) {
  (void)state;
  for (int n = 1; n <= 60; n++) {
    char text[2048];
    snprintf(text, sizeof text,
             "&simulation end_time = 61e-7 step = 1e-7 /\n" PAIR
             "&drive region = 'left' component = 'x' velocity = 1 start = %de-7 /\n"
             "&monitor name = 'r' kind = 'reaction' region = 'left' component = 'x' /\n"
             "&output frames = 0 sample = 1e-7 /\n",
             n);
    small_run r;
    small_open(&r, &elastic_bar, text);
    assert_non_null(r.simulation);
    assert_int_equal(small_go(&r), STEP_END);
    assert_true(small_largest(&r, "r") < 1e-6 * mass() / 1e-7 + stiffness() * 61e-7);
    small_close(&r);
  }
}

/* What does not jump keeps its values: a ramp acts in a step with its value there. */
static void ramps_act_as_they_are(void **state) {
  (void)state;
  const motion m = {
      FIXED "&force region = 'right' component = 'x' total = 100 start = %.17g rise = 1e-5 /\n",
      40.3, "u", NULL, 1};
  small_run r = open_run(&m, STEPS);
  const sweep *w = simulation_state(r.simulation, 0);
  const long right = w->body->lattice->particle_site[1];
  const double dt = w->body->time_step, start = m.start * end_time() / STEPS;
  simulation_advance(r.simulation, 40, NULL);
  assert_true(w->body->velocity[0][right] == 0);
  simulation_advance(r.simulation, 1, NULL); /* with the force at step 40: 0 */
  assert_true(w->body->velocity[0][right] == 0);
  simulation_advance(r.simulation, 1, NULL);
  const double part = (41 * dt - start) / 1e-5;
  assert_true(fabs(w->body->velocity[0][right] / (dt / mass() * 100 * part) - 1) < 1e-9);
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_force_may_begin_at_any_time),
      cmocka_unit_test(a_table_may_begin_with_a_jump),
      cmocka_unit_test(a_body_falls_five_centimetres_in_one_step),
      cmocka_unit_test(gravity_may_begin_at_any_time),
      cmocka_unit_test(damping_and_velocities_at_the_start),
      cmocka_unit_test(damping_takes_what_its_drag_does),
      cmocka_unit_test(a_drive_may_begin_at_any_time),
      cmocka_unit_test(a_flying_particle_is_caught_where_it_is),
      cmocka_unit_test(an_impulse_does_work),
      cmocka_unit_test(rounding_does_not_make_an_impulse_a_reaction),
      cmocka_unit_test(ramps_act_as_they_are),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
