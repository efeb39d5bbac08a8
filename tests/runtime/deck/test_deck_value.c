/* Values of a deck: numbers with units into SI, bounds, choices, and keys that go with a choice. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "runtime/deck/deck_value.h"

typedef struct notation {
  arena *memory;
  source_set sources;
  diagnostics said;
  namelist *groups;
} notation;

static void read_text(notation *n, const char *text) {
  *n = (notation){.memory = arena_new()};
  diag_begin(&n->said, &n->sources);
  n->groups = namelist_read(n->memory, &n->sources,
                            source_add(&n->sources, "t.nml", text, strlen(text)), &n->said);
  assert_int_equal(n->said.errors, 0);
}

static void forget(notation *n) {
  diag_clear(&n->said);
  source_clear(&n->sources);
  arena_free(n->memory);
}

static void assert_last(const notation *n, diag_code code, const char *message) {
  assert_true(n->said.count > 0);
  const diagnostic *last = &n->said.items[n->said.count - 1];
  if (last->code != code || !strstr(last->message, message)) {
    diag_print(&n->said, stderr);
    fail_msg("expected \"%s\"", message);
  }
}

static const namelist_value *value_of(const notation *n, const char *key) {
  return &namelist_find(&n->groups->groups[0], key)->values[0];
}

static bool read_real(notation *n, const char *key, const char *si_unit, deck_bound bound,
                      double *x) {
  return deck_real_read(value_of(n, key), key, si_unit, bound, x, &n->said);
}

static void quantities_keep_their_dimension(void **state) {
  (void)state;
  notation n;
  deck_quantity q;
  read_text(&n, "&g a = 12.5 b = '12.5 mm' c = ' -3d2 ' d = '2 kN/m^2' /\n");
  assert_true(deck_quantity_read(value_of(&n, "a"), "a", &q, &n.said));
  assert_true(q.value == 12.5 && !q.has_unit);
  assert_true(deck_quantity_read(value_of(&n, "b"), "b", &q, &n.said));
  assert_true(fabs(q.value - 0.0125) < 1e-17 && q.has_unit);
  assert_true(deck_quantity_read(value_of(&n, "c"), "c", &q, &n.said));
  assert_true(q.value == -300 && !q.has_unit);
  assert_true(deck_quantity_read(value_of(&n, "d"), "d", &q, &n.said));
  unit pascal;
  const char *bad;
  size_t length;
  assert_true(unit_parse("Pa", 2, &pascal, &bad, &length));
  assert_true(q.value == 2000 && dim_equal(q.dim, pascal.dim));
  assert_int_equal(n.said.count, 0);
  forget(&n);
}

static void reals_fit_their_unit_and_bound(void **state) {
  (void)state;
  static const struct {
    const char *text, *unit;
    deck_bound bound;
    diag_code code;
    const char *message; /* NULL: good */
  } cases[] = {
      {"'3 mm'", "m", BOUND_POSITIVE, 0, NULL},
      {"0", "m", BOUND_NOT_NEGATIVE, 0, NULL},
      {"1", "1", BOUND_FRACTION, 0, NULL},
      {"0", "m", BOUND_POSITIVE, DIAG_OUT_OF_BOUNDS, "`x` must be greater than 0"},
      {"'-1 mm'", "m", BOUND_NOT_NEGATIVE, DIAG_OUT_OF_BOUNDS, "`x` must not be negative"},
      {"1.01", "1", BOUND_FRACTION, DIAG_OUT_OF_BOUNDS, "greater than 0 and at most 1"},
      {"'3 s'", "m", BOUND_NONE, DIAG_UNITS, "`x` is a length; `3 s` is a time"},
      {"'3'", "m", BOUND_NONE, DIAG_UNITS, "`x` is a length, but this text has no unit"},
      {"'3 mn'", "m", BOUND_NONE, DIAG_UNKNOWN_UNIT, "there is no unit `mn`"},
      {"'three'", "m", BOUND_NONE, DIAG_BAD_VALUE, "must be a number, or a number with a unit"},
      {".true.", "m", BOUND_NONE, DIAG_BAD_VALUE, "`x` is a number, but this is a logical value"},
      {"'3 m'", "N*m", BOUND_NONE, DIAG_UNITS, "`x` is a moment"},
      {"1e41", "m", BOUND_NONE, DIAG_OUT_OF_BOUNDS, "too large to compute with"},
      {"1e-41", "m", BOUND_POSITIVE, DIAG_OUT_OF_BOUNDS, "too small to compute with"},
      {"'1e300 km^3'", "m^3", BOUND_NONE, DIAG_BAD_NUMBER, "the value of `x` is too large"}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    notation n;
    char text[64];
    double x;
    snprintf(text, sizeof text, "&g x = %s /\n", cases[k].text);
    read_text(&n, text);
    const bool good = read_real(&n, "x", cases[k].unit, cases[k].bound, &x);
    if (cases[k].message) assert_last(&n, cases[k].code, cases[k].message);
    assert_int_equal(good, cases[k].message == NULL);
    assert_int_equal(n.said.errors, good ? 0 : 1);
    forget(&n);
  }
}

static void choices_are_one_of_some_words(void **state) {
  (void)state;
  notation n;
  read_text(&n, "&g a = 'ramp' b = 'cosin' c = 'zebra' d = 'ramp', 'ramp' e = 3 /\n");
  const namelist_group *g = &n.groups->groups[0];
  static const char choices[] = "constant|ramp|cosine";
  assert_int_equal(deck_choice_read(n.memory, namelist_find(g, "a"), choices, &n.said), 1);
  assert_int_equal(deck_choice_read(n.memory, namelist_find(g, "b"), choices, &n.said), -1);
  assert_last(&n, DIAG_BAD_VALUE, "`b` cannot be `cosin`");
  assert_string_equal(n.said.items[0].hint, "did you mean `cosine`?");
  assert_int_equal(deck_choice_read(n.memory, namelist_find(g, "c"), choices, &n.said), -1);
  assert_string_equal(n.said.items[1].hint, "it is one of `constant`, `ramp`, `cosine`");
  assert_int_equal(deck_choice_read(n.memory, namelist_find(g, "d"), choices, &n.said), -1);
  assert_last(&n, DIAG_BAD_VALUE, "`d` takes 1 value, but 2 are given");
  assert_int_equal(deck_choice_read(n.memory, namelist_find(g, "e"), choices, &n.said), -1);
  assert_last(&n, DIAG_BAD_VALUE, "`e` is a text, but this is a number");
  forget(&n);
}

/* "0,5" is two values. */
static void values_are_counted(void **state) {
  (void)state;
  notation n;
  read_text(&n, "&g a = 0,5, 1,5 b = 1, 2 /\n");
  const namelist_group *g = &n.groups->groups[0];
  assert_true(deck_values_counted(namelist_find(g, "b"), 2, &n.said));
  assert_false(deck_values_counted(namelist_find(g, "a"), 2, &n.said));
  assert_last(&n, DIAG_BAD_VALUE, "`a` takes 2 values, but 4 are given");
  assert_string_equal(n.said.items[0].hint, "decimals are written with a point, not a comma");
  assert_false(deck_values_counted(namelist_find(g, "b"), 3, &n.said));
  assert_null(n.said.items[1].hint);
  forget(&n);
}

static void keys_go_with_their_choice(void **state) {
  (void)state;
  enum { DISC, BOX };
  static const deck_key_use uses[] = {{"centre", 1 << DISC, true},
                                      {"radius", 1 << DISC, true},
                                      {"size", 1 << BOX, true},
                                      {"rotation", 1 << DISC | 1 << BOX, false}};
  notation n;
  read_text(&n, "&g centre = 0, 0 radius = 1 rotation = 3 other = 5 /\n");
  const namelist_group *g = &n.groups->groups[0];
  assert_true(deck_keys_fit(g, uses, 4, DISC, "a disc", &n.said));
  assert_false(deck_keys_fit(g, uses, 4, BOX, "a box", &n.said));
  assert_int_equal(n.said.errors, 3); /* two that do not go with it, one that it needs */
  assert_string_equal(n.said.items[0].message, "`centre` does not go with a box");
  assert_string_equal(n.said.items[0].hint, "a box has `size`, `rotation`");
  assert_last(&n, DIAG_MISSING_KEY, "a box needs `size`");
  forget(&n);
}

/* A cut does not split a character of more than one byte. */
static void long_texts_are_cut(void **state) {
  (void)state;
  arena *a = arena_new();
  char text[200] = "";
  assert_string_equal(deck_shown(a, "short"), "short");
  for (int k = 0; k < 59; k++)
    text[k] = 'x';
  strcat(text, "\xC3\xA4yz and more");
  const char *shown = deck_shown(a, text);
  assert_int_equal(strlen(shown), 62);
  assert_string_equal(shown + 58, "x...");
  arena_free(a);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(quantities_keep_their_dimension),
      cmocka_unit_test(reals_fit_their_unit_and_bound),
      cmocka_unit_test(choices_are_one_of_some_words),
      cmocka_unit_test(values_are_counted),
      cmocka_unit_test(keys_go_with_their_choice),
      cmocka_unit_test(long_texts_are_cut),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
