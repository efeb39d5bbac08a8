/* What the checks of groups share: names that must be known, keys that exclude each other,
   directions in the plane and in space, times after the end. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/deck/deck_check.h"
#include "runtime/deck/group_body.h"
#include "tests/runtime/built_rows.h"

#define RUN "&simulation end_time = 2 /\n&material lattice = 'a' model = 'm' /\n"
#define REST                                                                                       \
  "&monitor name = 'load' kind = 'reaction' region = 'bottom' component = 'y' /\n"                 \
  "&support region = 'bottom' fix = 'x', 'y' /\n"
static const char plane[] = RUN "&lattice name = 'a' kind = 'square' spacing = 1 thickness = 1 /\n"
                                "&body lattice = 'a' shape = 'disc' centre = 0, 0 radius = 9 /\n"
                                "&region name = 'bottom' shape = 'point' at = 0, 0 /\n" REST;
static const char space[] = RUN "&lattice name = 'a' kind = 'cubic' spacing = 1 /\n"
                                "&body lattice = 'a' shape = 'sphere' centre = 3*0 radius = 9 /\n"
                                "&region name = 'bottom' shape = 'point' at = 3*0 /\n" REST;

typedef struct reading {
  built_rows of;
  deck deck;
  deck_reader reader;
} reading;

static void begin(reading *r, const char *text) {
  *r = (reading){0};
  read_deck(&r->of, text);
  if (!r->of.deck) diag_print(&r->of.said, stderr);
  assert_non_null(r->of.deck);
  assert_int_equal(r->of.said.count, 0);
  r->deck = *r->of.deck;
  r->reader =
      (deck_reader){.memory = r->of.memory, .d = &r->of.said, .k = &r->deck, .names_known = true};
}

/* The one message since the last call says this, at that place of the deck. */
static void check_said(reading *r, diag_code code, span where, const char *sentence) {
  diagnostics *d = &r->of.said;
  assert_int_equal(d->count, 1);
  assert_int_equal(d->items[0].code, code);
  if (!strstr(d->items[0].message, sentence))
    fail_msg("%s, not: %s", d->items[0].message, sentence);
  assert_int_equal(d->items[0].where.begin, where.begin);
  assert_int_equal(d->items[0].where.end, where.end);
  diag_clear(d);
  diag_begin(d, &r->of.sources);
}

static void check_silent(const reading *r) {
  assert_int_equal(r->of.said.count, 0);
}

static void names_must_be_those_of_a_group(void **state) {
  (void)state;
  reading r;
  begin(&r, plane);
  const deck_item *body = &r.deck.bodys[0].item, *monitor = &r.deck.monitors[0].item;
  const span at = monitor->where;
  assert_true(deck_lattice_known(&r.reader, body, "a"));
  assert_true(deck_item_region_known(&r.reader, monitor, "bottom"));
  assert_true(deck_region_known(&r.reader, at, "bottom"));
  assert_true(deck_monitor_known(&r.reader, at, "load"));
  check_silent(&r);
  assert_false(deck_lattice_known(&r.reader, body, "b"));
  check_said(&r, DIAG_UNKNOWN_NAME, deck_where(body, "lattice"), "there is no lattice `b`");
  assert_false(deck_item_region_known(&r.reader, monitor, "button"));
  assert_non_null(strstr(r.of.said.items[0].hint, "bottom"));
  check_said(&r, DIAG_UNKNOWN_NAME, deck_where(monitor, "region"), "there is no region `button`");
  assert_false(deck_monitor_known(&r.reader, at, "bottom"));
  check_said(&r, DIAG_UNKNOWN_NAME, at, "there is no monitor `bottom`");
  r.reader.names_known = false; /* it may be the name that could not be read */
  assert_false(deck_lattice_known(&r.reader, body, "b"));
  assert_false(deck_region_known(&r.reader, at, "button"));
  assert_true(deck_region_known(&r.reader, at, "bottom"));
  check_silent(&r);
  built_end(&r.of);
}

static void a_new_name_is_short_and_not_yet_there(void **state) {
  (void)state;
  char name[NAMELIST_LONGEST_NAME + 2];
  reading r;
  begin(&r, plane);
  const deck_item *second = &r.deck.monitors[0].item, *first = &r.deck.regions[0].item;
  memset(name, 'n', sizeof name);
  name[NAMELIST_LONGEST_NAME + 1] = 0;
  deck_check_name(&r.reader, "monitor", name + 1, second, NULL);
  deck_check_name(&r.reader, "monitor", NULL, second, NULL);
  check_silent(&r);
  deck_check_name(&r.reader, "monitor", name, second, NULL);
  check_said(&r, DIAG_TOO_LONG, deck_where(second, "name"), "a name may have up to");
  deck_check_name(&r.reader, "monitor", "load", second, first);
  assert_int_equal(r.of.said.items[0].note_where.begin, deck_where(first, "name").begin);
  check_said(&r, DIAG_DUPLICATE_NAME, deck_where(second, "name"),
             "a monitor `load` exists already");
  built_end(&r.of);
}

static void names_that_are_missing_are_like_none(void **state) {
  (void)state;
  static const char *const words[] = {"disc", "sphere"};
  assert_true(deck_same_name("a", "a"));
  assert_false(deck_same_name("a", "A"));
  assert_false(deck_same_name("a", NULL) || deck_same_name(NULL, NULL));
  assert_true(deck_is_one_of("sphere", words, 2));
  assert_false(deck_is_one_of("sphere", words, 1) || deck_is_one_of("spher", words, 2));
}

static const namelist_group *first_group(reading *r, const char *text) {
  const int file = source_add(&r->of.sources, "more.nml", text, strlen(text));
  const namelist *n = namelist_read(r->of.memory, &r->of.sources, file, &r->of.said);
  check_silent(r);
  return &n->groups[0];
}

static void of_two_keys_that_exclude_each_other_the_second_is_wrong(void **state) {
  (void)state;
  reading r;
  begin(&r, plane);
  const namelist_group *both = first_group(&r, "&force start = 1 rise = 2 /\n"),
                       *one = first_group(&r, "&force start = 1 /\n");
  deck_refuse_both(&r.reader, one, "start", "rise");
  deck_refuse_both(&r.reader, one, "rise", "start");
  check_silent(&r);
  deck_refuse_both(&r.reader, both, "start", "rise");
  assert_int_equal(r.of.said.items[0].note_where.begin,
                   namelist_find(both, "start")->name_where.begin);
  check_said(&r, DIAG_CONFLICT, namelist_find(both, "rise")->name_where,
             "`start` and `rise` exclude each other");
  built_end(&r.of);
}

static void places_have_the_dimensions_of_their_lattice(void **state) {
  (void)state;
  reading r;
  begin(&r, plane);
  const namelist_group *group = first_group(&r, "&body corner = 0, 0 size = 1, 1 radius = 3 /\n");
  deck_check_places(&r.reader, group, &deck_group_body, 2);
  check_silent(&r);
  deck_check_places(&r.reader, group, &deck_group_body, 3);
  assert_int_equal(r.of.said.count, 2); /* a radius is no place */
  for (int k = 0; k < 2; k++)
    assert_non_null(strstr(r.of.said.items[k].message, "takes 3 values in space, but 2 are given"));
  built_end(&r.of);
}

/* One lattice need not be named; of several, or of one that is not there, nothing is known. */
static void dimensions_are_those_of_the_lattice(void **state) {
  (void)state;
  const char *const texts[] = {plane, space};
  for (int k = 0; k < 2; k++) {
    reading r;
    begin(&r, texts[k]);
    assert_int_equal(deck_dimensions_of(&r.reader, "a"), 2 + k);
    assert_int_equal(deck_dimensions_of(&r.reader, NULL), 2 + k);
    assert_int_equal(deck_dimensions_of(&r.reader, "b"), 0);
    assert_int_equal(deck_dimensions_of_region(&r.reader, "bottom"), 2 + k);
    assert_int_equal(deck_dimensions_of_region(&r.reader, "top"), 0);
    assert_int_equal(deck_dimensions_of_region(&r.reader, NULL), 2 + k);
    r.deck.lattice_count = 2;
    assert_int_equal(deck_dimensions_of(&r.reader, NULL), 0);
    built_end(&r.of);
  }
}

/* x|y|z|rotation|rotation_x... as written: the third degree of freedom is the rotation in the
   plane, z in space, where the next three are rotations. */
static void the_third_degree_of_freedom_turns_in_the_plane(void **state) {
  (void)state;
  static const struct {
    const char *deck, *third, *refusal;
    int right, wrong, is;
  } cases[] = {
      {plane, "rotation", "there is no direction z in the plane", DECK_WRITTEN_ROTATION,
       DECK_WRITTEN_Z, 2},
      {plane, "rotation", "in the plane particles rotate about one axis", DECK_WRITTEN_ROTATION,
       DECK_WRITTEN_ROTATION + 1, 2},
      {space, "z", "in space particles rotate about three axes", DECK_WRITTEN_Z,
       DECK_WRITTEN_ROTATION, 2},
      {space, "z", "in space particles rotate about three axes", DECK_WRITTEN_ROTATION + 3,
       DECK_WRITTEN_ROTATION, 5},
  };
  for (int k = 0; k < 4; k++) {
    reading r;
    begin(&r, cases[k].deck);
    const deck_item *item = &r.deck.monitors[0].item;
    int component = cases[k].right;
    assert_int_equal(deck_component(&r.reader, item->where, "bottom", 0), 0);
    assert_int_equal(deck_component(&r.reader, item->where, "bottom", 1), 1);
    assert_true(deck_take_component(&r.reader, item, "bottom", &component));
    assert_int_equal(component, cases[k].is);
    assert_true(deck_is_rotation(&r.reader, "bottom", 2) == (k < 2));
    assert_true(deck_is_rotation(&r.reader, "bottom", 3));
    assert_false(deck_is_rotation(&r.reader, "bottom", 1));
    assert_string_equal(deck_component_of(&r.reader, "bottom", 1), "y");
    assert_string_equal(deck_component_of(&r.reader, "bottom", 2), cases[k].third);
    check_silent(&r);
    component = cases[k].wrong;
    assert_false(deck_take_component(&r.reader, item, "bottom", &component));
    assert_int_equal(component, cases[k].wrong);
    check_said(&r, DIAG_BAD_VALUE, deck_where(item, "component"), cases[k].refusal);
    built_end(&r.of);
  }
}

/* `fix = 'rotation'` holds the one rotation of the plane, and all three of space. */
static void all_rotations_are_held_at_once(void **state) {
  (void)state;
  const char *const decks[] = {plane, space};
  for (int k = 0; k < 2; k++) {
    reading r;
    begin(&r, decks[k]);
    const deck_item *item = &r.deck.monitors[0].item;
    const int all = 1 << DECK_WRITTEN_ROTATION;
    assert_int_equal(deck_components(&r.reader, item->where, "bottom", 1 | all),
                     k ? 1 | 56 : 1 | 4);
    check_silent(&r);
    if (k == 1)
      assert_int_equal(deck_components(&r.reader, item->where, "bottom", 4 | 2 * all), 4 | 8);
    built_end(&r.of);
  }
}

static void what_begins_with_the_end_is_late(void **state) {
  (void)state;
  reading r;
  begin(&r, plane);
  const deck_item *item = &r.deck.monitors[0].item;
  deck_warn_late(&r.reader, item, "zero_at", 1.999);
  check_silent(&r);
  deck_warn_late(&r.reader, item, "zero_at", 2);
  check_said(&r, DIAG_DECK_WARNING, item->where, "`zero_at` is not before the end of the run");
  r.deck.simulation.end_time = 0; /* not known */
  deck_warn_late(&r.reader, item, "zero_at", 3);
  check_silent(&r);
  built_end(&r.of);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(names_must_be_those_of_a_group),
      cmocka_unit_test(a_new_name_is_short_and_not_yet_there),
      cmocka_unit_test(names_that_are_missing_are_like_none),
      cmocka_unit_test(of_two_keys_that_exclude_each_other_the_second_is_wrong),
      cmocka_unit_test(places_have_the_dimensions_of_their_lattice),
      cmocka_unit_test(dimensions_are_those_of_the_lattice),
      cmocka_unit_test(the_third_degree_of_freedom_turns_in_the_plane),
      cmocka_unit_test(all_rotations_are_held_at_once),
      cmocka_unit_test(what_begins_with_the_end_is_late),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
