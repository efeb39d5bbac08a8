/* How far a run is, and the deck's time after so many steps, in dynamic and in quasi-static runs.
   */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/loads/load_clock.h"
#include "runtime/simulation/relaxation.h"
#include "runtime/simulation/run_clock.h"

static void dynamic_runs_count_steps(void **state) {
  (void)state;
  const run_clock c = {.at = {.step = 30}, .time_step = 0.25, .step_count = 120};
  assert_int_equal(run_clock_position(&c), 30);
  assert_int_equal(run_clock_end(&c), 120);
  assert_true(run_clock_time(&c) == 7.5);
}

static void quasi_static_runs_count_increments(void **state) {
  (void)state;
  const deck_relaxation asked = {.increments = 8};
  const relaxation r = {.state = {.done = 3}, .interval = 0.5, .deck = &asked};
  const run_clock c = {.at = {.step = 4711}, .time_step = 0.25, .relaxation = &r};
  assert_int_equal(run_clock_position(&c), 3);
  assert_int_equal(run_clock_end(&c), 8);
  assert_true(run_clock_time(&c) == 1.5);
}

/* A constant that begins at 1.0625 s, with steps of 0.25 s: the one at 1 s covers 0.875 .. 1.125 s,
   a quarter of it after the start; before it there is nothing, after it all. */
static void a_jump_counts_as_far_as_its_step_covers_it(void **state) {
  (void)state;
  const load_clock c = {.ramp = 0};
  const body w = {.time_step = 0.25};
  const time_function f = {.shape = TIME_CONSTANT, .value = 8, .start = 1.0625};
  assert_true(load_clock_time(&c, &w, 4) == 1);
  assert_true(load_clock_part_after(&w, f.start, 1) == 0.25);
  assert_true(load_clock_acting(&c, &w, &f, 3) == 0);
  assert_true(load_clock_acting(&c, &w, &f, 4) == 2);
  assert_true(load_clock_acting(&c, &w, &f, 5) == 8);
  assert_true(load_clock_part_after(&w, 0, 0) == 1); /* the run begins with what begins at 0 */
}

/* From 2 s to 4 s in ten steps, the first after step 100; then time stands. */
static void loads_go_evenly_through_an_increment(void **state) {
  (void)state;
  const load_clock c = {.from = 2, .to = 4, .first = 100, .ramp = 10};
  const body w = {.time_step = 0.25};
  const time_function ramp = {.shape = TIME_RAMP, .value = 3, .rise = 1},
                      later = {.shape = TIME_CONSTANT, .value = 5, .start = 4},
                      within = {.shape = TIME_CONSTANT, .value = 5, .start = 3};
  assert_true(load_clock_time(&c, &w, 100) == 2);
  assert_true(load_clock_time(&c, &w, 105) == 3);
  assert_true(load_clock_time(&c, &w, 150) == 4);
  assert_true(load_clock_value(&c, &w, &ramp, time_function_at, 105) == 0.5 * 6 + 0.5 * 12);
  /* What begins with the end comes in the next increment; what begins on the way, evenly. */
  assert_true(load_clock_value(&c, &w, &later, time_function_at, 110) == 0);
  assert_true(load_clock_value(&c, &w, &within, time_function_at, 105) == 2.5);
  assert_true(load_clock_acting(&c, &w, &within, 105) == 2.5);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(dynamic_runs_count_steps),
                                     cmocka_unit_test(quasi_static_runs_count_increments),
                                     cmocka_unit_test(a_jump_counts_as_far_as_its_step_covers_it),
                                     cmocka_unit_test(loads_go_evenly_through_an_increment)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
