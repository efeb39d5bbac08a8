/* What a simulation is made of when the time loop takes it over; when a run takes samples and
   frames, and when it ends: stops, interrupts, times between steps; what is observed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/sweep.h"
#include "runtime/simulation/simulation_state.h"
#include "runtime/simulation/time_loop.h"
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
  must_coast(&r, text);
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
  must_coast(&r, text);
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
  must_coast(&r, text);
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

/* Parts of a simulation that belong together are set up so: one body for all, a thread for each of
   its blocks, a clock with the step and the steps that were chosen; nothing has happened yet. */
static void parts_of_a_simulation_agree(void **state) {
  (void)state;
  static const char *const more[] = {"", "&relaxation increments = 3 /\n"};
  for (int quasi_static = 0; quasi_static < 2; quasi_static++) {
    char text[1024];
    const int head = snprintf(text, sizeof text,
                              COASTING "&gravity acceleration = 0, -9.81 /\n"
                                       "&output frames = 3 /\n",
                              1.0 * SPACING);
    snprintf(text + head, sizeof text - (size_t)head, "%s", more[quasi_static]);
    small_run r;
    must_open(&r, &elastic_bar, text);
    const simulation *s = r.simulation;
    const run_body *b = &s->bodies[0];
    assert_int_equal(s->body_count, 1);
    assert_ptr_equal(b->body, b->state->body);
    assert_ptr_equal(b->body->lattice, b->lattice_rows);
    assert_ptr_equal(s->monitors->bodies, s->bodies);
    assert_ptr_equal(s->history.monitors, s->monitors);
    assert_true(s->clock.time_step == 1e-7 && s->limit.step == 1e-7);
    assert_true(b->body->time_step == s->clock.time_step);
    assert_int_equal(s->clock.step_count, s->plan.step_count);
    assert_int_equal(s->history.capacity, s->plan.history_capacity);
    assert_int_equal(b->laws[0].bonds[0].i + b->laws[0].bonds[0].j, 1);
    assert_true((s->relaxation != NULL) == quasi_static);
    assert_ptr_equal(s->clock.relaxation, s->relaxation);
    assert_ptr_equal(s->history.relaxation, s->relaxation);
    if (quasi_static) assert_ptr_equal(s->relaxation->bodies, s->bodies);
    assert_int_equal(s->clock.at.begun + s->clock.at.step + s->clock.at.samples, 0);
    assert_int_equal(s->clock.at.status, STEP_OK);
    assert_int_equal(s->clock.at.stop, -1);
    assert_int_equal(s->observed_step, -1);
    small_close(&r);
  }
}

/* A pair of particles drawn apart by u feels EA u/s. A state is observed once: what stands in the
   forces then stays until the next step. */
static void a_state_is_observed_once(void **state) {
  (void)state;
  enum { STEPS = 10 };
  char text[1024];
  snprintf(text, sizeof text, COASTING "&output frames = 0 energy = .false. /\n", 1.0 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  simulation *s = r.simulation;
  const int32_t *site = s->bodies[0].lattice_rows->particle_site;
  double *const u = s->bodies[0].body->displacement[0], *const f = s->bodies[0].body->force[0];
  u[site[1]] = 1e-6;
  time_loop_observe(s);
  const double expected = rigidity_axial(0.2) * 1e-6 / SPACING;
  assert_int_equal(s->clock.at.begun, 1);
  assert_int_equal(s->observed_step, 0);
  assert_true(fabs(f[site[0]] / expected - 1) < 1e-12 && f[site[1]] == -f[site[0]]);
  f[site[0]] = 4711;
  time_loop_observe(s);
  assert_true(f[site[0]] == 4711);
  assert_int_equal(time_loop_run(s, STEPS, NULL), STEP_OK);
  assert_int_equal(s->clock.at.step, STEPS);
  time_loop_observe(s);
  assert_int_equal(s->observed_step, STEPS);
  const double now = rigidity_axial(0.2) * (u[site[1]] - u[site[0]]) / SPACING;
  assert_true(now < expected && fabs(f[site[0]] / now - 1) < 1e-12);
  small_close(&r);
}

/* Any number of advances takes the same steps as one, to the last bit; a run that has ended stays
   as it is. */
static void advances_may_be_of_any_length(void **state) {
  (void)state;
  static const long lengths[] = {1, 7, 31, 1000};
  double way[4], velocity[4];
  char text[1024];
  snprintf(text, sizeof text, COASTING "&output frames = 0 sample = 3e-7 /\n", 1.0 * SPACING);
  for (int k = 0; k < 4; k++) {
    small_run r;
    must_open(&r, &elastic_bar, text);
    simulation *s = r.simulation;
    const long site = s->bodies[0].lattice_rows->particle_site[1];
    s->bodies[0].body->velocity[0][site] = 2;
    long done = 0;
    for (step_status at = STEP_OK; at == STEP_OK; done += lengths[k]) {
      assert_int_equal(s->clock.at.step, done);
      at = time_loop_run(s, lengths[k], NULL);
    }
    assert_int_equal(s->clock.at.step, 100);
    way[k] = s->bodies[0].body->displacement[0][site];
    velocity[k] = s->bodies[0].body->velocity[0][site];
    assert_int_equal(time_loop_run(s, 5, NULL), STEP_END);
    assert_true(s->bodies[0].body->displacement[0][site] == way[k]);
    assert_true(s->clock.at.step == 100 && way[k] == way[0] && velocity[k] == velocity[0]);
    small_close(&r);
  }
  assert_true(way[0] > 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_stop_ends_the_run_at_its_sample),
      cmocka_unit_test(frames_are_taken_at_the_nearest_step),
      cmocka_unit_test(a_stop_waits_for_its_time),
      cmocka_unit_test(times_between_steps_are_rounded_to_the_nearest),
      cmocka_unit_test(an_interrupt_ends_an_advance_at_a_step),
      cmocka_unit_test(parts_of_a_simulation_agree),
      cmocka_unit_test(a_state_is_observed_once),
      cmocka_unit_test(advances_may_be_of_any_length),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
