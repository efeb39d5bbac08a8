/* The history of a run: which series it has, in what units and words, and that each sample stands
   where it was put. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/simulation/history.h"

enum { MONITORS = 2, SAMPLES = 5 };

static const deck_monitor asked[MONITORS] = {{.name = "load"}, {.name = "way"}};
static const deck of_deck = {.monitors = asked, .monitor_count = MONITORS};
static monitor watched[MONITORS] = {{.deck = &asked[0], .unit = "N"},
                                    {.deck = &asked[1], .unit = "m"}};
static const monitors both = {.items = watched, .count = MONITORS, .deck = &of_deck};
static const run_contacts none;
static const run_stamps no_stamps;

static void check_series(const history *h, int k, const char *name, const char *symbol) {
  const char *found;
  assert_string_equal(history_series(h, k, &found, NULL), name);
  assert_string_equal(found, symbol);
}

static void monitors_come_first_then_energies_then_increments(void **state) {
  (void)state;
  const relaxation r = {.interval = 1};
  history h = history_new(&both, &none, &no_stamps, &r, NULL, true, SAMPLES);
  arena *memory = arena_new();
  assert_int_equal(h.series_count, MONITORS + LEDGER_COUNT + 2);
  check_series(&h, 0, "load", "N");
  check_series(&h, 1, "way", "m");
  for (int e = 0; e < LEDGER_COUNT; e++) {
    check_series(&h, MONITORS + e, ledger_names[e], "J");
    assert_string_equal(history_words(&h, MONITORS + e, memory), ledger_words[e]);
  }
  check_series(&h, h.series_count - 2, "relaxation_steps", "1");
  check_series(&h, h.series_count - 1, "relaxation_unbalance", "1");
  assert_string_equal(history_words(&h, h.series_count - 2, memory), "steps of the increment");
  assert_string_equal(ledger_names[history_imbalance(&h, -1) - MONITORS], "energy/imbalance");
  assert_ptr_equal(history_energies(&h), h.sampled + MONITORS);
  history_free(&h);
  arena_free(memory);
}

static void without_energies_nothing_judges(void **state) {
  (void)state;
  const relaxation r = {.interval = 1};
  history dynamic = history_new(&both, &none, &no_stamps, NULL, NULL, false, SAMPLES),
          quasi_static = history_new(&both, &none, &no_stamps, &r, NULL, false, SAMPLES);
  assert_int_equal(dynamic.series_count, MONITORS);
  assert_null(history_energies(&dynamic));
  assert_int_equal(history_imbalance(&dynamic, -1), -1);
  assert_int_equal(quasi_static.series_count, MONITORS + 2);
  check_series(&quasi_static, MONITORS, "relaxation_steps", "1");
  assert_int_equal(history_imbalance(&quasi_static, -1), -1);
  history_free(&dynamic);
  history_free(&quasi_static);
}

/* The step, where it may shrink. */
static void the_step_comes_last(void **state) {
  (void)state;
  run_clock clock = {.time_step = 8e-6};
  history h = history_new(&both, &none, &no_stamps, NULL, &clock, true, SAMPLES);
  const double *step;
  assert_int_equal(h.series_count, MONITORS + LEDGER_COUNT + 1);
  check_series(&h, h.series_count - 1, "time_step", "s");
  history_add(&h, 0, 0);
  clock.at.halvings = 3;
  history_add(&h, 1, 1e-3);
  history_series(&h, h.series_count - 1, NULL, &step);
  assert_true(step[0] == 8e-6 && step[1] == 1e-6);
  history_free(&h);
}

/* Sample n of series k is 100 k + n, up to the last that there is room for; what an increment took
   is the relaxation's. */
static void samples_stand_where_they_were_put(void **state) {
  (void)state;
  relaxation r = {.interval = 1};
  history h = history_new(&both, &none, &no_stamps, &r, NULL, true, SAMPLES);
  const int monitored = h.series_count - 2;
  for (int n = 0; n < SAMPLES; n++) {
    for (int k = 0; k < monitored; k++)
      h.sampled[k] = 100 * k + n;
    r.state.steps = 100 * monitored + n;
    r.state.unbalance = 100 * (monitored + 1) + n;
    history_add(&h, n, 0.25 * n);
  }
  for (int k = 0; k < h.series_count; k++) {
    const double *values;
    history_series(&h, k, NULL, &values);
    for (int n = 0; n < SAMPLES; n++)
      assert_true(values[n] == 100 * k + n && h.time[n] == 0.25 * n);
  }
  history_free(&h);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(monitors_come_first_then_energies_then_increments),
      cmocka_unit_test(the_step_comes_last),
      cmocka_unit_test(without_energies_nothing_judges),
      cmocka_unit_test(samples_stand_where_they_were_put),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
