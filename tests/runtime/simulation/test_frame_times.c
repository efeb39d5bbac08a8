/* When frames are taken: at given times, at the first sample at which a monitor says so, beside
   those of &output, each state once; and the same ones by a run that was resumed. */
#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <unistd.h>

#include <cmocka.h>

#include "runtime/simulation/frame_times.h"
#include "runtime/simulation/simulation_save.h"
#include "tests/runtime/continuum/hooke_law.h"
#include "tests/runtime/simulation/chain.h"
#include "tests/runtime/simulation/same_runs.h"

enum { MOST = 32, STRIDE = 7 };
static const char path[] = "test_frame_times.state";

/* 100 steps of 1e-7 s; particles at 2 m/s have gone 0.2 um a step. */
#define WAY             "&monitor name = 'way' kind = 'displacement' region = 'left' component = 'x' /\n"
#define SAMPLED(frames) "&output frames = " frames " sample = 1e-6 /\n"

typedef struct taken {
  int count;
  long step[MOST];
  double time[MOST];
} taken;

static void take(small_run *r, taken *t) {
  assert_true(t->count < MOST);
  t->step[t->count] = simulation_step_done(r->simulation);
  t->time[t->count++] = simulation_time(r->simulation);
  simulation_frame_taken(r->simulation);
  assert_false(simulation_frame_due(r->simulation));
}

/* As a run does: up to that step, whose frame is not taken, or to the end. */
static step_status march(small_run *r, long until, taken *t) {
  step_status status = STEP_OK;
  while (status == STEP_OK && simulation_step_done(r->simulation) < until) {
    const long left = until - simulation_step_done(r->simulation);
    if (simulation_frame_due(r->simulation)) take(r, t);
    status = simulation_advance(r->simulation, left < STRIDE ? left : STRIDE, NULL);
  }
  if (status != STEP_OK && simulation_frame_due(r->simulation)) take(r, t);
  return status;
}

static void at_steps(const taken *t, int count, const long *expected) {
  bool same = t->count == count;
  for (int k = 0; k < count && same; k++)
    same = t->step[k] == expected[k];
  for (int k = 0; k < t->count && !same; k++)
    print_message("a frame at step %ld\n", t->step[k]);
  assert_true(same);
}
#define AT_STEPS(t, ...)                                                                           \
  at_steps(t, (int)(sizeof(const long[]){__VA_ARGS__} / sizeof(long)), (const long[]){__VA_ARGS__})

static void coast(small_run *r, const char *more) {
  char text[2048];
  const int head = snprintf(text, sizeof text, COASTING WAY, 1.0 * SPACING);
  snprintf(text + head, sizeof text - (size_t)head, "%s", more);
  must_coast(r, text);
}

static step_status coasted(const char *more, taken *t) {
  small_run r;
  *t = (taken){.count = 0};
  coast(&r, more);
  const step_status status = march(&r, LONG_MAX, t);
  small_close(&r);
  return status;
}

/* --- at times --------------------------------------------------------------------------------- */

static void frames_are_taken_at_given_times(void **state) {
  (void)state;
  taken t;
  coasted("&frame at = 1e-6 /\n&output frames = 0 /\n", &t);
  AT_STEPS(&t, 10, 100); /* the last state, too */
  coasted("&frame at = '2.04 us', 1e-6, 0, '2.04 us' /\n&frame at = '9.96 us', '1.98 us' /\n"
          "&output frames = 0 /\n",
          &t);
  AT_STEPS(&t, 0, 10, 20, 100);
  coasted("&frame at = '3 us', '2.5 us', '10 us' /\n&output frames = 4 /\n", &t);
  AT_STEPS(&t, 0, 25, 30, 50, 75, 100);
  coasted("&output frames = 0 /\n", &t);
  assert_int_equal(t.count, 0);
}

/* The clock counts positions; the deck times: the nearest, never one behind the end. */
static void times_are_positions_of_the_clock(void **state) {
  (void)state;
  const double at[] = {3.49e-6, 3.51e-6, 1e-5, 1.00000001e-5};
  deck_frame frames[] = {{.at = at, .at_count = 4}};
  deck k = {.frames = frames, .frame_count = 1, .simulation.end_time = 1e-5};
  const run_clock clock = {.time_step = 1e-6, .step_count = 10, .at.last_frame_step = -1};
  frame_times f;
  frame_times_open(&f, &k, &clock);
  assert_int_equal(f.count, 3);
  assert_true(f.position[0] == 3 && f.position[1] == 4 && f.position[2] == 10);
  assert_int_equal(frame_times_next(&f), 3);
  assert_false(frame_times_due(&f));
  frame_times_close(&f);
}

/* A bar drawn out over 8 increments of 1/8 s each; times are those of the nearest increment. */
#define DRAWN                                                                                      \
  "&simulation end_time = 1 /\n" CHAIN                                                             \
  "&material lattice = 'c' model = 'm' /\n" POINT("left", "0", "0") POINT(                         \
      "right", "0.01", "0") "&support region = 'left' fix = 'xy' /\n"                              \
                            "&support region = 'right' fix = 'y' /\n"                              \
                            "&drive region = 'right' component = 'x' displacement = 8e-6 history " \
                            "= 'ramp' rise = 1 /\n"                                                \
                            "&monitor name = 'u' kind = 'displacement' region = 'right' "          \
                            "component = 'x' /\n&relaxation increments = 8 tolerance = 1e-3 /\n"

static void drawn(small_run *r, taken *t, const char *more) {
  char text[2048];
  const int head = snprintf(text, sizeof text, DRAWN, 1.0 * SPACING);
  snprintf(text + head, sizeof text - (size_t)head, "%s", more);
  *t = (taken){.count = 0};
  must_open(r, &elastic_bar, text);
  assert_int_equal(march(r, LONG_MAX, t), STEP_END);
}

static void at_eighths(const taken *t, int count, const long *expected) {
  assert_int_equal(t->count, count);
  for (int k = 0; k < count; k++)
    assert_true(fabs(8 * t->time[k] - (double)expected[k]) < 1e-12);
}
#define AT_EIGHTHS(t, ...)                                                                         \
  at_eighths(t, (int)(sizeof(const long[]){__VA_ARGS__} / sizeof(long)),                           \
             (const long[]){__VA_ARGS__})

static void quasi_static_runs_take_the_nearest_increment(void **state) {
  (void)state;
  taken t;
  small_run r;
  drawn(&r, &t, "&frame at = 0.3, 0.7 /\n&output frames = 0 /\n");
  AT_EIGHTHS(&t, 2, 6, 8);
  small_close(&r);
  drawn(&r, &t, "&frame at = 0, 0.4, 0.49, 1 /\n&output frames = 2 /\n");
  AT_EIGHTHS(&t, 0, 3, 4, 8);
  small_close(&r);
  drawn(&r, &t, "&frame monitor = 'u' above = '2.5 um' /\n&output frames = 0 /\n");
  AT_EIGHTHS(&t, 3, 8);
  assert_true(fabs(simulation_frame_came(r.simulation, 0) - 0.375) < 1e-15);
  small_close(&r);
  drawn(&r, &t, "&frame monitor = 'u' above = '2.5 um' after = 0.5 /\n&output frames = 4 /\n");
  AT_EIGHTHS(&t, 0, 2, 4, 6, 8);
  small_close(&r);
}

/* --- when a monitor says so ------------------------------------------------------------------- */

/* 7.5 um is passed at step 38; samples are at every tenth. */
static void an_event_has_one_frame_at_its_first_sample(void **state) {
  (void)state;
  static const char above[] = "&frame monitor = 'way' above = '7.5 um' /\n";
  char text[512];
  taken t;
  snprintf(text, sizeof text, "%s%s", above, SAMPLED("0"));
  coasted(text, &t);
  AT_STEPS(&t, 40, 100);
  snprintf(text, sizeof text, "%s%s", above, SAMPLED("4"));
  coasted(text, &t);
  AT_STEPS(&t, 0, 25, 40, 50, 75, 100);
  snprintf(text, sizeof text, "%s%s%s", above, above, SAMPLED("5")); /* and one of these is there */
  coasted(text, &t);
  AT_STEPS(&t, 0, 20, 40, 60, 80, 100);
  coasted("&frame monitor = 'way' above = '0.5 um' after = '4.5 us' /\n" SAMPLED("0"), &t);
  AT_STEPS(&t, 50, 100);
  coasted("&frame monitor = 'way' above = '1 m' /\n" SAMPLED("1"), &t);
  AT_STEPS(&t, 0, 100);
  coasted("&frame monitor = 'way' above = '19 um' /\n" SAMPLED("0"), &t); /* 20 um at the end */
  AT_STEPS(&t, 100);
}

/* It holds at the start: the frame there is the event's, whichever comes first. */
static void an_event_may_hold_from_the_start(void **state) {
  (void)state;
  taken t;
  coasted("&frame monitor = 'way' below = '1 um' /\n" SAMPLED("0"), &t);
  AT_STEPS(&t, 0, 100);
  coasted("&frame monitor = 'way' below = '1 um' /\n" SAMPLED("2"), &t);
  AT_STEPS(&t, 0, 50, 100);
  coasted("&frame at = 0 /\n&frame monitor = 'way' below = '1 um' /\n" SAMPLED("0"), &t);
  AT_STEPS(&t, 0, 100);
}

static void a_stop_and_its_event_share_a_frame(void **state) {
  (void)state;
  taken t;
  const step_status status = coasted("&stop monitor = 'way' above = '7.5 um' /\n"
                                     "&frame monitor = 'way' above = '7.5 um' /\n" SAMPLED("0"),
                                     &t);
  assert_int_equal(status, STEP_STOPPED);
  AT_STEPS(&t, 40);
}

/* A pair that swings: below half of the largest opening so far, for the first time, as the samples
   of the history have it. */
static void a_fraction_of_the_peak_comes_once(void **state) {
  (void)state;
  char text[1024];
  snprintf(text, sizeof text,
           COASTING "&monitor name = 'open' kind = 'opening' between = 'left', 'right' component = "
                    "'x' /\n&frame monitor = 'open' below = 0.5 of = 'peak' /\n"
                    "&frame monitor = 'open' below = 0.5 of = 'peak' after = '9 us' /\n"
                    "&output frames = 0 sample = 2e-7 /\n",
           1.0 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  body *b = simulation_state(r.simulation, 0)->body;
  b->velocity[0][b->lattice->particle_site[1]] = 2;
  taken t = {.count = 0};
  assert_int_equal(march(&r, LONG_MAX, &t), STEP_END);
  const double *time, *open = small_values(&r, "open");
  const long samples = simulation_history(r.simulation, &time);
  double peak = 0, first[2] = {-1, -1};
  for (long k = 0; k < samples; k++) {
    peak = fmax(peak, fabs(open[k]));
    for (int n = 0; n < 2; n++)
      if (fabs(open[k]) < 0.5 * peak && first[n] < 0 && time[k] >= 9e-6 * n) first[n] = time[k];
  }
  assert_true(first[0] > 1e-6 && first[0] < 9e-6); /* not at the start, where all is 0 */
  int expected = 1;                                /* the last state */
  for (int n = 0; n < 2; n++) {
    assert_true(simulation_frame_came(r.simulation, n) == first[n]);
    expected += first[n] > 0 && first[n] < time[samples - 1];
  }
  assert_int_equal(t.count, expected);
  assert_true(t.time[0] == first[0]);
  small_close(&r);
}

/* Whoever takes no frames is not held up. */
static void a_frame_that_nobody_takes_holds_nothing_up(void **state) {
  (void)state;
  small_run r;
  coast(&r, "&frame monitor = 'way' above = '7.5 um' /\n&frame at = '2 us' /\n" SAMPLED("0"));
  assert_int_equal(small_go(&r), STEP_END);
  assert_true(simulation_frame_due(r.simulation));
  assert_true(fabs(simulation_frame_came(r.simulation, 0) - 4e-6) < 1e-18);
  small_close(&r);
}

/* --- static runs ------------------------------------------------------------------------------ */

#define PULLED                                                                                     \
  "&simulation end_time = 4 /\n&static increments = 4 /\n"                                         \
  "&mesh name = 'plate' size = 1, 0.5 nodes = 5, 3 thickness = 0.1 method = 'finite_elements' /\n" \
  "&material mesh = 'plate' model = 'hooke' /\n"                                                   \
  "&region name = 'left' shape = 'segment' from = 0, 0 to = 0, 0.5 /\n"                            \
  "&region name = 'right' shape = 'segment' from = 1, 0 to = 1, 0.5 /\n"                           \
  "&support region = 'left' fix = 'xy' /\n"                                                        \
  "&drive region = 'right' component = 'x' displacement = '4 mm' history = 'ramp' rise = 4 /\n"    \
  "&monitor name = 'u' kind = 'displacement' region = 'right' component = 'x' /\n"                 \
  "&output frames = 0 /\n"

static void pulled(const char *text, double first, int count) {
  small_run r;
  taken t = {.count = 0};
  must_open(&r, &hooke_law, text);
  assert_int_equal(march(&r, LONG_MAX, &t), STEP_END);
  assert_int_equal(t.count, count);
  assert_true(t.time[0] == first && t.time[count - 1] == 4);
  small_close(&r);
  must_open(&r, &hooke_law, text); /* and nobody takes them */
  assert_int_equal(small_go(&r), STEP_END);
  small_close(&r);
}

static void static_runs_have_events(void **state) {
  (void)state;
  pulled(PULLED "&frame monitor = 'u' above = '1.5 mm' /\n", 2, 2);
  pulled(PULLED "&frame monitor = 'u' below = '0.5 mm' /\n", 0, 2);
  pulled(PULLED "&frame monitor = 'u' above = '3.5 mm' /\n", 4, 1);
  pulled(PULLED "&frame at = 0.8, 3 /\n", 1, 3);
}

/* --- resumed ---------------------------------------------------------------------------------- */

static void hand_on(small_run *first, small_run *second) {
  char error[200];
  assert_true(
      simulation_save(first->simulation, path, "frames", &(frame_mark){0, 0}, error, sizeof error));
  assert_true(simulation_restore(second->simulation, path, "frames", NULL, error, sizeof error));
}

/* Before and after the event, in its step before its frame is taken and after. */
static void a_resumed_run_takes_the_same_frames(void **state) {
  (void)state;
  static const char more[] = "&frame monitor = 'way' above = '7.5 um' /\n&frame at = '1.5 us' /\n"
                             "&frame monitor = 'way' above = '1 m' /\n" SAMPLED("4");
  static const long stops[] = {0, 1, 15, 38, 40, 41, 50, 99};
  small_run straight;
  taken t = {.count = 0};
  coast(&straight, more);
  march(&straight, LONG_MAX, &t);
  AT_STEPS(&t, 0, 15, 25, 40, 50, 75, 100);
  for (int k = 0; k < 16; k++) {
    small_run first, second;
    taken u = {.count = 0};
    coast(&first, more);
    coast(&second, more);
    march(&first, stops[k / 2], &u);
    if (k % 2 && simulation_frame_due(first.simulation)) take(&first, &u);
    hand_on(&first, &second);
    small_close(&first);
    assert_int_equal(march(&second, LONG_MAX, &u), STEP_END);
    AT_STEPS(&u, 0, 15, 25, 40, 50, 75, 100);
    same_runs(&straight, &second);
    for (int n = 0; n < 3; n++)
      assert_true(simulation_frame_came(second.simulation, n) ==
                  simulation_frame_came(straight.simulation, n));
    small_close(&second);
  }
  assert_true(simulation_frame_came(straight.simulation, 2) < 0);
  small_close(&straight);
  unlink(path);
}

/* No frame changes what a run comes to. */
static void frames_change_no_bit(void **state) {
  (void)state;
  small_run with, without;
  taken t = {.count = 0};
  coast(&with, "&frame monitor = 'way' above = '7.5 um' /\n&frame at = '1.5 us' /\n" SAMPLED("0"));
  coast(&without, SAMPLED("0"));
  march(&with, LONG_MAX, &t);
  assert_int_equal(t.count, 3);
  small_go(&without);
  same_runs(&with, &without);
  small_close(&with);
  small_close(&without);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(frames_are_taken_at_given_times),
      cmocka_unit_test(times_are_positions_of_the_clock),
      cmocka_unit_test(quasi_static_runs_take_the_nearest_increment),
      cmocka_unit_test(an_event_has_one_frame_at_its_first_sample),
      cmocka_unit_test(an_event_may_hold_from_the_start),
      cmocka_unit_test(a_stop_and_its_event_share_a_frame),
      cmocka_unit_test(a_fraction_of_the_peak_comes_once),
      cmocka_unit_test(a_frame_that_nobody_takes_holds_nothing_up),
      cmocka_unit_test(static_runs_have_events),
      cmocka_unit_test(a_resumed_run_takes_the_same_frames),
      cmocka_unit_test(frames_change_no_bit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
