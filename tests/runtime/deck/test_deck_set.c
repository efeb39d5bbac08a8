/* Overrides: which group and key is meant, what shells leave of quotes, what is taken back, former names. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>

#include "runtime/deck/deck_set.h"

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

/* A notation of its own: a group that occurs once, one that has names, one that takes any key. */
static const deck_key_info run_keys[] = {{.name = "title", .type = DECK_TEXT},
                                         {.name = "end", .type = DECK_REAL, .unit = "s"}};
static const deck_key_info load_keys[] = {
    {.name = "name", .type = DECK_NAME},
    {.name = "size", .former = "force", .type = DECK_REAL, .unit = "N"},
    {.name = "at", .type = DECK_PLACE, .unit = "m"}};
static const deck_group_info groups[] = {
    {.name = "run", .single = true, .keys = run_keys, .key_count = 2},
    {.name = "load", .identity = "name", .keys = load_keys, .key_count = 3},
    {.name = "law", .open = true, .keys = run_keys, .key_count = 1}};
static const deck_grammar grammar = {.file = "recipe", .groups = groups, .group_count = 3};

static const char recipe[] =
    "&load name = 'left' force = 1 /\n&load name = 'right' size = 2 /\n&law E = 5 /\n";

static void set(notation *n, const char *override) {
  read_text(n, recipe);
  deck_present_names(n->groups, &grammar, &n->said);
  deck_set(n->memory, &n->sources, n->groups, &grammar, &(deck_override){override}, 1, &n->said);
}

static bool leave_nothing_out(const char *group, const char *key) {
  (void)group, (void)key;
  return false;
}

static void values_replace_and_are_added(void **state) {
  (void)state;
  static const char *const cases[][2] = {
      {"load[left].size=3", "&load name = 'left' size = 3 /"},
      {"load[2].size=7 kN", "&load name = 'right' size = '7 kN' /"},
      {"load[right].at=4 mm, 0.1", "&load name = 'right' size = 2 at = '4 mm', 0.1 /"},
      {" &LOAD[1].FORCE = 8", "&load name = 'left' size = 8 /"},
      {"run.title=two, words", "&run title = 'two, words' /"},
      {"run.title='quoted'", "&run title = 'quoted' /"},
      {"law.nu=0.2", "&law e = 5 nu = 0.2 /"},
      {"law.E=", "&law /"},
      {"load[left].size=", "&load name = 'left' /"}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    notation n;
    set(&n, cases[k][0]);
    if (n.said.count) diag_print(&n.said, stderr);
    assert_int_equal(n.said.count, 0);
    /* compared as groups: their text has one spelling for one meaning */
    notation expected;
    read_text(&expected, cases[k][1]);
    char *wanted = namelist_text(expected.memory, expected.groups, leave_nothing_out);
    char *found = namelist_text(n.memory, n.groups, leave_nothing_out);
    if (!strstr(found, wanted)) fail_msg("%s: no\n%s in\n%s", cases[k][0], wanted, found);
    forget(&expected);
    forget(&n);
  }
}

static void what_is_not_there_is_told(void **state) {
  (void)state;
  static const struct {
    const char *override;
    diag_code code;
    const char *message;
  } cases[] = {
      {"size=3", DIAG_DECK_SYNTAX, "an override has the form group.key=value"},
      {"load[.size=3", DIAG_DECK_SYNTAX, "an override has the form"},
      {"load.size", DIAG_DECK_SYNTAX, "an override has the form"},
      {"lode[1].size=3", DIAG_UNKNOWN_GROUP, "there is no group `&lode`"},
      {"load[1].sise=3", DIAG_UNKNOWN_KEY, "`&load` has no key `sise`"},
      {"load[middle].size=3", DIAG_UNKNOWN_NAME, "none of the recipe's 2 `&load` is `middle`"},
      {"load[3].size=3", DIAG_UNKNOWN_NAME, "none of the recipe's 2 `&load` is `3`"},
      {"load.size=3", DIAG_UNKNOWN_GROUP, "the recipe has 2 `&load` that could be meant"},
      {"law.F=", DIAG_UNKNOWN_KEY, "this `&law` gives no `F` to take back"}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    notation n;
    set(&n, cases[k].override);
    assert_int_equal(n.said.errors, 1);
    assert_last(&n, cases[k].code, cases[k].message);
    const span where = n.said.items[0].where; /* in the override, not in the file */
    assert_string_equal(n.sources.items[where.file].text, cases[k].override);
    assert_true(where.end <= strlen(cases[k].override));
    forget(&n);
  }
}

static void both_names_of_a_key_are_one_too_many(void **state) {
  (void)state;
  notation n;
  read_text(&n, "&load size = 1 force = 2 /\n&law force = 3 /\n");
  deck_present_names(n.groups, &grammar, &n.said);
  assert_int_equal(n.said.errors, 1);
  assert_last(&n, DIAG_DUPLICATE_KEY, "`force` is a former name of `size`");
  assert_null(namelist_find(&n.groups->groups[0], "force"));
  assert_non_null(namelist_find(&n.groups->groups[1], "force")); /* there it means something else */
  forget(&n);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(values_replace_and_are_added),
      cmocka_unit_test(what_is_not_there_is_told),
      cmocka_unit_test(both_names_of_a_key_are_one_too_many),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
