/* When a run takes samples and frames, and when it ends: stops, interrupts, times between steps. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/sweep.h"
#include "tests/runtime/simulation/chain.h"

static void a_stop_ends_the_run_at_its_sample(void **state) {
  (void)state;
  char text[2048];
  snprintf(text, sizeof text,
           COASTING
           "&monitor name = 'way' kind = 'displacement' region = 'left' component = 'x' /\n"
           "&stop monitor = 'way' above = '7.5 um' after = 4e-6 /\n"
           "&output frames = 4 sample = 1e-6 energy = .false. /\n",
           1.0 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  sweep *w = simulation_state(r.simulation);
  w->body->velocity[0][w->body->lattice->particle_site[0]] = w->body->velocity[0][w->body->lattice->particle_site[1]] = 2;
  int frames = 0;
  step_status status = STEP_OK;
  while (status == STEP_OK) {
    if (simulation_frame_due(r.simulation)) {
      frames++;
      simulation_frame_taken(r.simulation);
    }
    status = simulation_advance(r.simulation, 7, NULL);
  }
  assert_int_equal(status, STEP_STOPPED);
  assert_int_equal(simulation_step_done(r.simulation), 40);
  assert_int_equal(frames, 2);                     /* at steps 0 and 25 */
  assert_true(simulation_frame_due(r.simulation)); /* the last state */
  simulation_frame_taken(r.simulation);
  assert_false(simulation_frame_due(r.simulation));
  small_close(&r);
}

/* Seven frames of a hundred steps, each at the step nearest to its time. */
static void frames_are_taken_at_the_nearest_step(void **state) {
  (void)state;
  static const long expected[] = {0, 14, 29, 43, 57, 71, 86, 100};
  char text[1024];
  snprintf(text, sizeof text, COASTING "&output frames = 7 energy = .false. /\n", 1.0 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  for (int k = 0; k < 8; k++) {
    assert_true(simulation_frame_due(r.simulation));
    assert_int_equal(simulation_step_done(r.simulation), expected[k]);
    simulation_frame_taken(r.simulation);
    simulation_advance(r.simulation, 1000, NULL);
  }
  assert_false(simulation_frame_due(r.simulation));
  small_close(&r);
}

/* The condition holds from the first sample after the start; the run goes on to the first after
   4.5 us. */
static void a_stop_waits_for_its_time(void **state) {
  (void)state;
  char text[2048];
  snprintf(text, sizeof text,
           COASTING
           "&monitor name = 'way' kind = 'displacement' region = 'left' component = 'x' /\n"
           "&stop monitor = 'way' above = '0.5 um' after = 4.5e-6 /\n"
           "&output frames = 0 sample = 1e-6 energy = .false. /\n",
           1.0 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  sweep *w = simulation_state(r.simulation);
  w->body->velocity[0][w->body->lattice->particle_site[0]] = w->body->velocity[0][w->body->lattice->particle_site[1]] = 2;
  assert_int_equal(small_go(&r), STEP_STOPPED);
  assert_int_equal(simulation_step_done(r.simulation), 50);
  small_close(&r);
}

/* Times that lie between two steps are those of the nearest: samples 2.7 steps apart, a zero at
   4.7, a mean over 2.7. */
static void times_between_steps_are_rounded_to_the_nearest(void **state) {
  (void)state;
  char text[2048];
  snprintf(text, sizeof text,
           COASTING
           "&monitor name = 'zeroed' kind = 'displacement' region = 'left' component = 'x' zero_at "
           "= 4.7e-7 /\n"
           "&monitor name = 'mean' kind = 'displacement' region = 'left' component = 'x' average = "
           "2.7e-7 /\n"
           "&output frames = 0 sample = 2.7e-7 energy = .false. /\n",
           1.0 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  sweep *w = simulation_state(r.simulation);
  w->body->velocity[0][w->body->lattice->particle_site[0]] = w->body->velocity[0][w->body->lattice->particle_site[1]] = 2;
  assert_int_equal(small_go(&r), STEP_END);
  const double *time, *zeroed, *mean;
  static const int steps[] = {0, 3, 5, 8, 11, 14, 16};
  assert_true(simulation_history(r.simulation, &time) > 7);
  simulation_series(r.simulation, small_series(&r, "zeroed"), NULL, &zeroed);
  simulation_series(r.simulation, small_series(&r, "mean"), NULL, &mean);
  for (int k = 0; k < 7; k++) {
    assert_true(fabs(time[k] - 1e-7 * steps[k]) < 1e-18);
    assert_true(fabs(zeroed[k] - 2e-7 * (steps[k] < 5 ? steps[k] : steps[k] - 5)) < 1e-18);
    assert_true(fabs(mean[k] - 2e-7 * (steps[k] > 0 ? steps[k] - 1 : 0)) < 1e-18);
  }
  small_close(&r);
}

static void an_interrupt_ends_an_advance_at_a_step(void **state) {
  (void)state;
  char text[1024];
  snprintf(text, sizeof text, COASTING "&output frames = 0 energy = .false. /\n", 1.0 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  const volatile sig_atomic_t interrupted = 1;
  assert_int_equal(simulation_advance(r.simulation, 50, &interrupted), STEP_OK);
  assert_int_equal(simulation_step_done(r.simulation), 0);
  assert_int_equal(simulation_advance(r.simulation, 50, NULL), STEP_OK);
  assert_int_equal(simulation_step_done(r.simulation), 50);
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_stop_ends_the_run_at_its_sample),
      cmocka_unit_test(frames_are_taken_at_the_nearest_step),
      cmocka_unit_test(a_stop_waits_for_its_time),
      cmocka_unit_test(times_between_steps_are_rounded_to_the_nearest),
      cmocka_unit_test(an_interrupt_ends_an_advance_at_a_step),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
