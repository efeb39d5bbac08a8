/* The keys of a load: how it develops in time, tables, and what does not go together. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "runtime/deck/deck_formula.h"
#include "runtime/deck/deck_load.h"
#include "tests/runtime/deck/notation.h"

static const deck_load_kind kinds[] = {{"velocity", "m/s", false, &deck_formula_of_all},
                                       {"displacement", "m", false, &deck_formula_of_all}};

static bool read_load(notation *n, const char *keys, time_function *f) {
  char text[512];
  snprintf(text, sizeof text, "&drive %s /\n", keys);
  read_text(n, text);
  const namelist_group *g = &n->groups->groups[0];
  *f = (time_function){0};
  const int kind = deck_load_kind_of(n->memory, g, kinds, 2, &n->said);
  return kind >= 0 && deck_load_read(n->memory, g, &kinds[kind], f, &n->said);
}

static void histories_are_what_their_keys_say(void **state) {
  (void)state;
  static const struct {
    const char *keys;
    time_shape shape;
    double t, value;
  } cases[] = {{"velocity = '3 mm/s'", TIME_CONSTANT, 1, 3e-3},
               {"velocity = 2 start = '2 ms'", TIME_CONSTANT, 1e-3, 0},
               {"displacement = 4 rise = 8", TIME_RAMP_HOLD, 2, 1},
               {"displacement = 4 rise = 8", TIME_RAMP_HOLD, 20, 4},
               {"displacement = 4 rise = 8 history = 'ramp'", TIME_RAMP, 20, 10},
               {"displacement = 4 rise = 8 history = 'cosine' start = 1", TIME_COSINE, 5, 2},
               {"velocity = 2 end = '2 ms'", TIME_CONSTANT, 1e-3, 2},
               {"velocity = 10 times = 0, '1 s', 3 values = 0, 1, -0.5", TIME_TABLE, 2, 2.5}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    notation n;
    time_function f;
    if (!read_load(&n, cases[k].keys, &f)) diag_print(&n.said, stderr);
    assert_int_equal(n.said.count, 0);
    assert_int_equal(f.shape, cases[k].shape);
    assert_true(fabs(time_function_at(&f, cases[k].t) - cases[k].value) < 1e-15);
    forget(&n);
  }
}

/* At x = 3 m; a formula that reads no place is the same everywhere. */
static void formulas_are_functions_of_place_and_time(void **state) {
  (void)state;
  static const struct {
    const char *keys;
    bool varies;
    double start_value, value, way; /* at once, at 2 s after the start, until then */
  } cases[] = {{"formula = '2 [m/s]*t/1 [s]' start = 1", false, 0, 4, 4},
               {"formula = '2 [mm]*x/1 [m]' start = '7 ms'", true, 6e-3, 6e-3, 12e-3},
               {"velocity = '3 mm/s' formula = 'x/1 [m] + (t/1 [s])**3'", true, 9e-3, 33e-3, 30e-3},
               {"formula = '0'", false, 0, 0, 0}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    notation n;
    time_function f;
    if (!read_load(&n, cases[k].keys, &f)) diag_print(&n.said, stderr);
    assert_int_equal(n.said.count, 0);
    assert_int_equal(f.shape, TIME_FORMULA);
    assert_int_equal(time_function_varies(&f), cases[k].varies);
    const time_function there = time_function_placed(&f, (double[]){3, 0, 0});
    assert_true(fabs(time_function_jump(&there) - cases[k].start_value) < 1e-15);
    assert_true(fabs(time_function_at(&there, f.start + 2) - cases[k].value) < 1e-14);
    assert_true(time_function_at(&there, f.start - 1e-3) == 0);
    assert_true(fabs(time_function_way(&there, f.start, f.start + 2, 3) - cases[k].way) < 1e-14);
    forget(&n);
  }
}

static void keys_that_do_not_go_together_are_told(void **state) {
  (void)state;
  static const struct {
    const char *keys;
    diag_code code;
    const char *message;
  } cases[] = {
      {"velocity = 1 history = 'cosine'", DIAG_MISSING_KEY, "a cosine needs `rise`"},
      {"velocity = 1 history = 'constant' rise = 1", DIAG_UNKNOWN_KEY,
       "`rise` does not go with a constant load"},
      {"velocity = 1 times = 0, 1", DIAG_MISSING_KEY, "a table needs `values`"},
      {"velocity = 1 times = 0 values = 1", DIAG_BAD_VALUE, "a table has at least two points"},
      {"velocity = 1 times = 0, 1, 1 values = 1, 2, 3", DIAG_OUT_OF_BOUNDS,
       "each of the `times` must be later than the one before"},
      {"velocity = 1 times = -1, 1 values = 1, 2", DIAG_OUT_OF_BOUNDS,
       "`times` must not be negative"},
      {"velocity = 1 rise = 0", DIAG_OUT_OF_BOUNDS, "`rise` must be greater than 0"},
      {"velocity = '1 mm'", DIAG_UNITS, "`velocity` is a velocity"}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    notation n;
    time_function f;
    assert_false(read_load(&n, cases[k].keys, &f));
    assert_last(&n, cases[k].code, cases[k].message);
    forget(&n);
  }
}

static void a_load_is_of_one_kind(void **state) {
  (void)state;
  static const char *const wrong[] = {"rise = 1", "velocity = 1 displacement = 2"};
  for (int k = 0; k < 2; k++) {
    notation n;
    time_function f;
    assert_false(read_load(&n, wrong[k], &f));
    assert_true(n.said.errors == 1);
    forget(&n);
  }
}

/* A factor needs no full value. */
static void a_factor_goes_from_0_to_1(void **state) {
  (void)state;
  notation n;
  time_function f = {0};
  read_text(&n, "&gravity acceleration = 0, -9.81 rise = 2 /\n");
  assert_true(deck_factor_read(n.memory, &n.groups->groups[0], "acceleration", &f, &n.said));
  assert_true(time_function_at(&f, 1) == 0.5 && time_function_at(&f, 3) == 1);
  forget(&n);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(histories_are_what_their_keys_say),
      cmocka_unit_test(formulas_are_functions_of_place_and_time),
      cmocka_unit_test(keys_that_do_not_go_together_are_told),
      cmocka_unit_test(a_load_is_of_one_kind),
      cmocka_unit_test(a_factor_goes_from_0_to_1),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
