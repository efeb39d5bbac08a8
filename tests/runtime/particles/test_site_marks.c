/* Which sites bodies and notches take: counts against closed forms, ends that belong to a body, points, and what is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "runtime/particles/site_marks.h"
#include "tests/runtime/built_rows.h"

#define DECK(shapes)                                                                               \
  "&simulation end_time = 1 /\n&lattice name = 'c' kind = 'square' spacing = 0.01 thickness = 1 "  \
  "/\n&material lattice = 'c' model = 'm' /\n" shapes
#define BODY(shape)  "&body lattice = 'c' shape = " shape " /\n"
#define NOTCH(shape) "&notch lattice = 'c' shape = " shape " /\n"

typedef struct marked {
  built_rows deck;
  bravais bravais;
  site_marks marks;
  bool good;
} marked;

static marked mark(const char *text) {
  marked m;
  read_deck(&m.deck, text);
  if (!m.deck.deck) diag_print(&m.deck.said, stderr);
  assert_non_null(m.deck.deck);
  const deck_lattice *l = &m.deck.deck->lattices[0];
  assert_true(bravais_of(l, &m.bravais));
  m.good = site_marks_make(&m.marks, &m.bravais, m.deck.deck, l, &m.deck.said);
  return m;
}

static void unmark(marked *m) {
  site_marks_free(&m->marks);
  built_end(&m->deck);
}

static long standing(const marked *m) {
  const site_range *r = &m->marks.span;
  long count = 0;
  for (long layer = r->first[2]; layer <= r->last[2]; layer++)
    for (long row = r->first[1]; row <= r->last[1]; row++)
      for (long column = r->first[0]; column <= r->last[0]; column++)
        count += site_marks_stands(&m->marks, column, row, layer);
  return count;
}

/* Sites on the outline belong to the body; the notch takes those on its own outline, too. */
static void outlines_belong_to_bodies_and_to_notches(void **state) {
  (void)state;
  marked m = mark(DECK(BODY("'rectangle' corner = 0, 0 size = 0.1, 0.05")
                           NOTCH("'rectangle' corner = 0.03, 0 size = 0.02, 0.02")));
  assert_true(m.good);
  assert_int_equal(standing(&m), 11 * 6 - 3 * 3);
  assert_int_equal(m.marks.removed[0], 9);
  assert_true(site_range_count(&m.marks.left) == 66);
  assert_false(site_marks_stands(&m.marks, 3, 2, 0));
  assert_true(site_marks_stands(&m.marks, 2, 2, 0) && site_marks_stands(&m.marks, 10, 5, 0));
  unmark(&m);
}

/* The number of sites of a disc is that of Gauss's circle problem: 1, 5, 13, 29, 49, 81, ... */
static void discs_hold_as_many_sites_as_gauss_says(void **state) {
  (void)state;
  static const long gauss[] = {1, 5, 13, 29, 49, 81, 113, 149, 197, 253, 317};
  for (int radius = 1; radius <= 10; radius++) {
    char text[512];
    snprintf(text, sizeof text, DECK(BODY("'disc' centre = 0, 0 radius = %g")), 0.01 * radius);
    marked m = mark(text);
    assert_int_equal(standing(&m), gauss[radius]);
    unmark(&m);
  }
}

/* Two bodies that overlap have the sites of both once; what a notch leaves is trimmed. */
static void what_is_left_is_trimmed(void **state) {
  (void)state;
  marked m = mark(DECK(BODY("'rectangle' corner = 0, 0 size = 0.04, 0.04")
                           BODY("'rectangle' corner = 0.02, 0.02 size = 0.04, 0.04")
                               NOTCH("'rectangle' corner = -0.005, -0.005 size = 0.03, 0.1")));
  assert_int_equal(standing(&m), 25 + 25 - 9 - 15 - 1 * 2);
  assert_int_equal(m.marks.left.first[0], 3);
  assert_int_equal(m.marks.left.last[0], 6);
  assert_int_equal(m.marks.left.first[1], 0);
  assert_int_equal(m.marks.left.last[1], 6);
  unmark(&m);
}

/* A point takes the nearest site, if one is within half a spacing; of equally near ones the first. */
static void a_point_takes_one_site(void **state) {
  (void)state;
  marked m = mark(DECK(BODY("'point' at = 0.033, 0.023")));
  assert_int_equal(standing(&m), 1);
  assert_true(site_marks_stands(&m.marks, 3, 2, 0));
  unmark(&m);
  m = mark(DECK(BODY("'point' at = 0.034, 0.024")));
  assert_false(m.good);
  assert_non_null(strstr(m.deck.said.items[0].message, "no site of lattice 'c' lies within 5 mm"));
  assert_non_null(strstr(m.deck.said.items[0].hint, "5.65685 mm away, is at '30 mm', '20 mm'"));
  unmark(&m);
  assert_true(fabs(site_point_reach(&(deck_shape){.within = 0}, 0.01) - 0.005) < 1e-7);
  assert_true(fabs(site_point_reach(&(deck_shape){.within = 0.02}, 0.01) - 0.02) < 1e-7);
}

static void what_holds_no_site_is_refused(void **state) {
  (void)state;
  static const struct {
    const char *deck, *message;
  } cases[] = {
      {DECK(BODY("'rectangle' corner = 0.001, 0.001 size = 0.005, 0.005")), "contains no site"},
      {DECK(BODY("'rectangle' corner = 0, 0 size = 0.02, 0.02")
                NOTCH("'rectangle' corner = -1, -1 size = 2, 2")),
       "the notches remove every site"},
      {DECK(BODY("'rectangle' corner = 0, 0 size = 1000, 1000")), "span 1e+10 sites"},
      {DECK(BODY("'rectangle' corner = 1e12, 0 size = 1, 1")), "farther than 1e+08 spacings"}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    marked m = mark(cases[k].deck);
    assert_false(m.good);
    const int last = m.deck.said.count - 1;
    if (last < 0 || !strstr(m.deck.said.items[last].message, cases[k].message))
      fail_msg("expected \"%s\"", cases[k].message);
    unmark(&m);
  }
}

static void ranges_are_counted_and_clipped(void **state) {
  (void)state;
  site_range r = {{0, -2, 1}, {9, 2, 1}};
  assert_true(site_range_count(&r) == 50);
  site_range_clip(&r, &(site_range){{3, -9, 0}, {20, 0, 5}});
  assert_true(site_range_count(&r) == 7 * 3);
  site_range_clip(&r, &(site_range){{3, 1, 0}, {20, 5, 5}});
  assert_true(site_range_count(&r) == 0);
}

static void a_name_chooses_the_lattice(void **state) {
  (void)state;
  const deck_lattice l = {.name = "c"};
  assert_true(site_of_lattice(&l, NULL) && site_of_lattice(&l, "c"));
  assert_false(site_of_lattice(&l, "d"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(outlines_belong_to_bodies_and_to_notches),
      cmocka_unit_test(discs_hold_as_many_sites_as_gauss_says),
      cmocka_unit_test(what_is_left_is_trimmed),
      cmocka_unit_test(a_point_takes_one_site),
      cmocka_unit_test(what_holds_no_site_is_refused),
      cmocka_unit_test(ranges_are_counted_and_clipped),
      cmocka_unit_test(a_name_chooses_the_lattice),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
