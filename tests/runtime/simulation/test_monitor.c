/* Monitors: means, zeros, scales and peaks; reactions between two regions; applied forces. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/filling/lattice.h"
#include "runtime/interaction/sweep.h"
#include "runtime/simulation/monitor_field.h"
#include "runtime/simulation/monitor_setup.h"
#include "runtime/simulation/monitor_values.h"
#include "runtime/simulation/monitor_words.h"
#include "tests/runtime/simulation/chain.h"

/* A pair that coasts at 2 m/s: means, zeros and scales have closed forms. */
static void means_zeros_and_scales_are_as_defined(void **state) {
  (void)state;
  char text[2048];
  snprintf(text, sizeof text,
           COASTING
           "&monitor name = 'now' kind = 'displacement' region = 'left' component = 'x' /\n"
           "&monitor name = 'mean' kind = 'displacement' region = 'left' component = 'x' average = "
           "1e-6 /\n"
           "&monitor name = 'zeroed' kind = 'displacement' region = 'left' component = 'x' zero_at "
           "= 5e-6 "
           "scale = -3 /\n"
           "&monitor name = 'gap' kind = 'opening' between = 'left', 'right' component = 'y' /\n"
           "&monitor name = 'speed' kind = 'velocity' region = 'right' component = 'x' /\n"
           "&output frames = 0 sample = 1e-6 energy = .false. /\n",
           1.0 * SPACING);
  small_run r;
  must_coast(&r, text);
  assert_int_equal(small_go(&r), STEP_END);
  const double *time, *now, *mean, *zeroed;
  assert_int_equal(simulation_history(r.simulation, &time), 11);
  simulation_series(r.simulation, small_series(&r, "now"), NULL, &now);
  simulation_series(r.simulation, small_series(&r, "mean"), NULL, &mean);
  simulation_series(r.simulation, small_series(&r, "zeroed"), NULL, &zeroed);
  for (int k = 0; k <= 10; k++) {
    assert_true(fabs(time[k] - k * 1e-6) < 1e-18);
    assert_true(fabs(now[k] - 2 * time[k]) < 1e-18);
    /* ten steps that end with the sample; at the start the one there is */
    assert_true(fabs(mean[k] - (k ? 2 * (time[k] - 4.5e-7) : 0)) < 1e-18);
    assert_true(fabs(zeroed[k] + 3 * (now[k] - (k < 5 ? 0 : 1e-5))) < 1e-17);
  }
  assert_true(small_last(&r, "gap") == 0);
  assert_true(fabs(small_last(&r, "speed") - 2) < 1e-12);
  double when;
  assert_true(fabs(simulation_monitor_peak(r.simulation, small_series(&r, "zeroed"), &when) +
                   3e-5) < 1e-16);
  assert_true(simulation_monitor_peak(r.simulation, small_series(&r, "speed"), &when) == 2);
  assert_true(when == 0); /* the first of equal values */
  small_close(&r);
}

/* A chain stretched from both ends, unevenly so that it also speeds up: the ends carry
   differently. */
static void the_reaction_between_two_regions_is_the_mean_of_both_ends(void **state) {
  (void)state;
  char text[2048];
  snprintf(
      text, sizeof text,
      "&simulation end_time = 1e-4 step_safety = 0.5 /\n" CHAIN
      "&material lattice = 'c' model = 'm' /\n" POINT("left", "0", "0") POINT(
          "right", "0.05",
          "0") "&drive region = 'left' component = 'x' displacement = '-2 um' rise = '0.1 ms' /\n"
               "&drive region = 'right' component = 'x' displacement = '6 um' rise = '0.1 ms' /\n"
               "&monitor name = 'left' kind = 'reaction' region = 'left' component = 'x' /\n"
               "&monitor name = 'right' kind = 'reaction' region = 'right' component = 'x' /\n"
               "&monitor name = 'load' kind = 'reaction' between = 'left', 'right' component = 'x' "
               "scale = 3 /\n"
               "&output frames = 0 sample = 1e-5 /\n",
      5 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  assert_int_equal(small_go(&r), STEP_END);
  const double *left, *right, *load;
  const char *symbol;
  simulation_series(r.simulation, small_series(&r, "left"), NULL, &left);
  simulation_series(r.simulation, small_series(&r, "right"), NULL, &right);
  simulation_series(r.simulation, small_series(&r, "load"), &symbol, &load);
  assert_string_equal(symbol, "N");
  double uneven = 0;
  for (long k = 0; k < simulation_history(r.simulation, NULL); k++) {
    assert_true(fabs(load[k] - 3 * 0.5 * (right[k] - left[k])) < 1e-12 * rigidity_axial(0.2));
    uneven = fmax(uneven, fabs(right[k] + left[k]));
  }
  assert_true(small_last(&r, "left") < 0 && small_last(&r, "right") > 0);
  assert_true(uneven > 1e-2 * small_last(&r, "right"));
  small_close(&r);
}

/* Two forces on one end, one of them on the whole chain: each particle has its share, and what is
   held has it too. */
static void the_applied_force_is_the_sum_of_what_acts_on_the_region(void **state) {
  (void)state;
  char text[2048];
  snprintf(
      text, sizeof text,
      "&simulation end_time = 1e-4 step = 1e-7 /\n" CHAIN
      "&material lattice = 'c' model = 'm' /\n" POINT("left", "0", "0") POINT(
          "right", "0.05",
          "0") "&region name = 'all' shape = 'rectangle' corner = "
               "-0.001, -0.001 size = 0.06, 0.002 /\n"
               "&support region = 'left' fix = 'x' /\n"
               "&force region = 'right' component = 'x' total = 300 rise = 1e-4 /\n"
               "&force region = 'all' component = 'x' total = -60 start = 5e-5 /\n"
               "&force region = 'right' component = 'y' total = 7 /\n"
               "&monitor name = 'at_right' kind = 'applied' region = 'right' component = 'x' /\n"
               "&monitor name = 'mean' kind = 'applied' region = 'right' component = 'x' average = "
               "1e-5 /\n"
               "&monitor name = 'up' kind = 'applied' region = 'all' component = 'y' scale = -2 /\n"
               "&monitor name = 'at_left' kind = 'applied' region = 'left' component = 'x' /\n"
               "&output frames = 0 sample = 1e-5 /\n",
      5 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  assert_int_equal(small_go(&r), STEP_END);
  const double *time, *right, *mean, *up, *left;
  const char *symbol;
  const long samples = simulation_history(r.simulation, &time);
  simulation_series(r.simulation, small_series(&r, "at_right"), &symbol, &right);
  simulation_series(r.simulation, small_series(&r, "mean"), NULL, &mean);
  simulation_series(r.simulation, small_series(&r, "up"), NULL, &up);
  simulation_series(r.simulation, small_series(&r, "at_left"), NULL, &left);
  assert_string_equal(symbol, "N");
  for (long k = 0; k < samples; k++) {
    const double share = time[k] > 5.1e-5 ? -10 : 0;
    if (fabs(time[k] - 5e-5) < 1e-6) continue; /* begins here, with a part of a step */
    assert_true(fabs(right[k] - (300 * time[k] / 1e-4 + share)) < 1e-9);
    assert_true(fabs(left[k] - share) < 1e-9 && fabs(up[k] + 14) < 1e-9);
  }
  /* the last 100 states, the present one included */
  assert_true(fabs(mean[4] - (right[4] - 300 * 49.5e-7 / 1e-4)) < 1e-9);
  small_close(&r);
}

/* --- by themselves ---------------------------------------------------------------------------- */

typedef struct watched {
  small_run run;
  rows *lattice;
  run_body of;
  monitors *monitors;
} watched;

#define WATCHED                                                                                    \
  COASTING                                                                                         \
  "&monitor name = 'way' kind = 'displacement' region = 'left' component = 'x' scale = -2 /\n"     \
  "&monitor name = 'mean' kind = 'displacement' region = 'right' component = 'x' average = 3e-7 "  \
  "zero_at = 5e-7 /\n"                                                                             \
  "&stop monitor = 'way' above = 3 after = 4e-6 /\n"                                               \
  "&stop monitor = 'mean' below = 0.5 of = 'peak' /\n"                                             \
  "&output frames = 0 energy = .false. /\n"

static void watch(watched *w) {
  char text[2048];
  snprintf(text, sizeof text, WATCHED, 1.0 * SPACING);
  must_open(&w->run, &elastic_bar, text);
  w->lattice = lattice_build(w->run.deck, 0, &w->run.said);
  w->of = (run_body){.name = "c", .lattice_rows = w->lattice, .law = &elastic_bar};
  w->of.loads = loads_new(w->run.deck, 0, w->lattice, "m", 2, &w->run.said);
  w->of.state = simulation_state(w->run.simulation, 0);
  w->of.body = w->of.state->body;
  w->monitors = monitors_new(w->run.deck, &w->of, 1, NULL, 0, NULL, 1e-7, &w->run.said);
  assert_non_null(w->monitors);
}

static void watch_no_more(watched *w) {
  monitors_free(w->monitors);
  loads_free(w->of.loads);
  rows_free(w->lattice);
  small_close(&w->run);
}

/* The right particle is put at n^2 mm after step n: means of three, less the mean at step 5. */
static void a_window_holds_the_last_steps(void **state) {
  (void)state;
  watched w;
  watch(&w);
  sweep *s = simulation_state(w.run.simulation, 0);
  const long left = s->body->lattice->particle_site[0], right = s->body->lattice->particle_site[1];
  double values[2], zero = 0;
  assert_int_equal(w.monitors->items[1].window, 3);
  for (long n = 0; n <= 12; n++) {
    double mean = 0;
    const long held = n < 2 ? n + 1 : 3;
    s->body->displacement[0][left] = 1e-3 * (double)(n == 7 ? -10 : n);
    s->body->displacement[0][right] = 1e-3 * (double)(n * n);
    for (long k = n - held + 1; k <= n; k++)
      mean += 1e-3 * (double)(k * k) / (double)held;
    monitors_step(w.monitors, n, 1);
    monitors_look(w.monitors, n, n);
    if (n == 5) zero = mean;
    monitors_sample(w.monitors, n, (double)n * 1e-7, values);
    assert_true(fabs(values[0] + 2 * s->body->displacement[0][left]) < 1e-18);
    assert_true(fabs(monitor_value_now(w.monitors, &w.monitors->items[1], n) -
                     1e-3 * (double)(n * n)) < 1e-18);
    assert_true(fabs(values[1] - (mean - zero)) < 1e-15);
  }
  assert_true(fabs(w.monitors->items[0].state.peak + 2 * 12e-3) < 1e-17); /* 24 is more than 20 */
  assert_true(fabs(w.monitors->items[0].state.peak_time - 12e-7) < 1e-20);
  watch_no_more(&w);
}

static void the_first_stop_that_applies_is_told(void **state) {
  (void)state;
  watched w;
  watch(&w);
  w.monitors->items[1].state.peak = -8;
  assert_int_equal(monitors_stop(w.monitors, 5e-6, (double[]){2.9, 4.1}), -1);
  assert_int_equal(monitors_stop(w.monitors, 5e-6, (double[]){-3.1, 3.9}), 0); /* by its size */
  assert_int_equal(monitors_stop(w.monitors, 5e-6, (double[]){2.9, -3.9}), 1);
  assert_int_equal(monitors_stop(w.monitors, 3e-6, (double[]){3.1, 4.1}), -1); /* too early */
  w.monitors->items[1].state.peak = 0;
  assert_int_equal(monitors_stop(w.monitors, 5e-6, (double[]){0, 0}),
                   -1); /* nothing was there yet */
  watch_no_more(&w);
}

/* Of points and particles, by their names in any case; what stands on bonds is none. */
static void fields_are_found_by_name(void **state) {
  (void)state;
  static const pl_field fields[] = {{.name = "D", .place = PL_ON_BOND},
                                    {.name = "kappa", .place = PL_ON_POINT}},
                        outputs[] = {{.name = "heat", .place = PL_ON_PARTICLE}};
  const pl_law law = {.field_count = 2, .fields = fields, .output_count = 1, .outputs = outputs};
  static const struct {
    const char *name;
    int place;
  } cases[] = {{"D", -1}, {"KAPPA", 1}, {"heat", 2}, {"none", -1}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    const deck_monitor m = {.kind = MONITOR_FIELD, .field = cases[k].name};
    assert_int_equal(monitor_find_field(&m, &law), cases[k].place);
  }
  assert_string_equal(monitor_law_field(&law, 2)->name, "heat");
  const double values[] = {1, 2, 4};
  assert_true(monitor_mean_at(values, (const int32_t[]){0, 2}, 2) == 2.5);
}

static void what_is_watched_stands_in_words(void **state) {
  (void)state;
  watched w;
  watch(&w);
  assert_string_equal(monitor_words(w.monitors, 0, w.run.memory),
                      "mean displacement along x of `left`, times -2");
  assert_string_equal(
      monitor_words(w.monitors, 1, w.run.memory),
      "mean displacement along x of `right`, mean over 3e-07 s, less its value at 5e-07 s");
  watch_no_more(&w);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(means_zeros_and_scales_are_as_defined),
      cmocka_unit_test(the_reaction_between_two_regions_is_the_mean_of_both_ends),
      cmocka_unit_test(the_applied_force_is_the_sum_of_what_acts_on_the_region),
      cmocka_unit_test(a_window_holds_the_last_steps),
      cmocka_unit_test(the_first_stop_that_applies_is_told),
      cmocka_unit_test(fields_are_found_by_name),
      cmocka_unit_test(what_is_watched_stands_in_words),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
