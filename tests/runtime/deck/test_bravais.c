/* Lattices without ends: how many neighbours stand how far, that places and numbers fit each other, and what lies out of them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "runtime/deck/bravais.h"
#include "tests/runtime/built_rows.h"

#define LATTICE(keys, body)                                                                        \
  "&simulation end_time = 1 /\n&lattice name = 'c' spacing = 0.01 " keys                           \
  " /\n&material lattice = 'c' model = 'm' /\n&body lattice = 'c' shape = " body " /\n"
#define PLANE(kind)                                                                                \
  LATTICE("kind = '" kind "' thickness = 0.1 rotation = 23 origin = 0.003, -0.002",                \
          "'rectangle' corner = 0, 0 size = 0.05, 0.05")
#define SPACE(kind)                                                                                \
  LATTICE("kind = '" kind "' rotation = 23 axis = 1, 2, 2 origin = 0.003, -0.002, 0.001",          \
          "'box' corner = 0, 0, 0 size = 0.03, 0.03, 0.03")

enum { SHELLS = 4 };
static const struct lattice_case {
  const char *deck, *kind;
  int dimensions;
  int count[SHELLS];     /* neighbours of each shell, from tables of crystallography */
  double square[SHELLS]; /* of their distance, in spacings */
  double measure;        /* of a site, in spacings */
} cases[] = {{PLANE("hexagonal"), "hexagonal", 2, {6, 6, 6, 12}, {1, 3, 4, 7}, 0.8660254037844386},
             {PLANE("square"), "square", 2, {4, 4, 4, 8}, {1, 2, 4, 5}, 1},
             {SPACE("cubic"), "cubic", 3, {6, 12, 8, 6}, {1, 2, 3, 4}, 1},
             {SPACE("fcc"), "fcc", 3, {12, 6, 24, 12}, {1, 2, 3, 4}, 0.7071067811865476}};
enum { CASES = sizeof cases / sizeof *cases };

static void shells_are_those_of_crystallography(void **state) {
  (void)state;
  for (int n = 0; n < CASES; n++) {
    built_rows b;
    bravais_neighbour list[PL_MAX_DIRECTIONS];
    build_rows(&b, cases[n].deck);
    const bravais *l = &b.rows->infinite;
    assert_int_equal(bravais_dimensions(cases[n].kind), cases[n].dimensions);
    assert_int_equal(l->dimensions, cases[n].dimensions);
    assert_true(fabs(l->site_measure / pow(0.01, l->dimensions) / cases[n].measure - 1) < 1e-14);
    for (int shells = 1, all = 0; shells <= SHELLS; shells++) {
      all += cases[n].count[shells - 1] / 2;
      assert_int_equal(bravais_family(l, 0, shells, list), all);
      assert_int_equal(list[all - 1].shell, shells);
      assert_true(fabs(list[all - 1].square - cases[n].square[shells - 1]) < 1e-14);
      const double horizon = sqrt(cases[n].square[shells - 1]); /* on it counts */
      assert_int_equal(bravais_family(l, horizon, 0, list), all);
      assert_int_equal(bravais_family(l, horizon * 0.99, 0, list),
                       all - cases[n].count[shells - 1] / 2);
    }
    assert_int_equal(bravais_family(l, 0, 0, list), cases[n].count[0] / 2);
    built_end(&b);
  }
  assert_int_equal(bravais_dimensions("quartz"), 0);
}

/* From any site a neighbour stands where its numbers say, a chord further; the list goes from near to far, with one of each
   pair of opposite neighbours. */
static void chords_lead_from_site_to_site(void **state) {
  (void)state;
  for (int n = 0; n < CASES; n++) {
    built_rows b;
    bravais_neighbour list[PL_MAX_DIRECTIONS];
    build_rows(&b, cases[n].deck);
    const bravais *l = &b.rows->infinite;
    const int count = bravais_family(l, 0, SHELLS, list);
    for (int k = 0; k < count; k++)
      for (long row = -3; row < 3; row++) {
        double from[3], to[3], chord[3];
        const long layer = l->dimensions == 3 ? row + 1 : 0;
        const int shift = bravais_shift(l, row, layer);
        const int there = bravais_shift(l, row + list[k].row, layer + list[k].layer);
        bravais_chord(l, &list[k], chord);
        bravais_place(l, 5, row, layer, from);
        assert_int_equal((list[k].halves + shift - there) % 2, 0);
        bravais_place(l, 5 + (list[k].halves + shift - there) / 2, row + list[k].row,
                      layer + list[k].layer, to);
        for (int d = 0; d < 3; d++)
          assert_true(fabs(from[d] + chord[d] - to[d]) < 1e-16);
        assert_true(fabs(bravais_distance(from, to) - 0.01 * sqrt(list[k].square)) < 1e-16);
        assert_true(k == 0 || list[k].square >= list[k - 1].square - 1e-14);
        assert_true(list[k].layer > 0 || (list[k].layer == 0 && list[k].row > 0) ||
                    (list[k].layer == 0 && list[k].row == 0 && list[k].halves > 0));
      }
    built_end(&b);
  }
}

static void coordinates_undo_places(void **state) {
  (void)state;
  for (int n = 0; n < CASES; n++) {
    built_rows b;
    build_rows(&b, cases[n].deck);
    const bravais *l = &b.rows->infinite;
    for (long k = -20; k <= 20; k++) {
      const long layer = l->dimensions == 3 ? 3 * k - 1 : 0;
      double at[3], back[3];
      bravais_place(l, 7 * k + 1, 2 * k - 5, layer, at);
      bravais_coordinates(l, at, back);
      assert_true(fabs(back[0] - 0.5 * bravais_shift(l, 2 * k - 5, layer) - (double)(7 * k + 1)) <
                  1e-12);
      assert_true(fabs(back[1] - (double)(2 * k - 5)) < 1e-12);
      assert_true(fabs(back[2] - (double)layer) < 1e-12);
    }
    built_end(&b);
  }
}

/* Laws of bonds run bond by bond on the hexagon of nearest neighbours, however it is asked for, and on nothing else. */
static void one_lattice_is_the_hexagon(void **state) {
  (void)state;
  static const struct {
    const char *deck;
    bool is_hexagon;
  } decks[] = {
#define HEXAGONAL(keys)                                                                            \
  LATTICE("kind = 'hexagonal' thickness = 0.1 " keys, "'rectangle' corner = 0, 0 size = 0.05, "    \
                                                      "0.05")
      {HEXAGONAL(""), true},
      {HEXAGONAL("shells = 1"), true},
      {HEXAGONAL("horizon = 1"), true},
      {HEXAGONAL("horizon = 1.7"), true},
      {HEXAGONAL("horizon = 1.8"), false},
      {HEXAGONAL("shells = 2"), false},
      {PLANE("square"), false},
      {SPACE("fcc"), false}};
  for (size_t k = 0; k < sizeof decks / sizeof *decks; k++) {
    built_rows b;
    read_deck(&b, decks[k].deck);
    assert_non_null(b.deck);
    if (bravais_is_hexagon(&b.deck->lattices[0]) != decks[k].is_hexagon) fail_msg("deck %zu", k);
    built_end(&b);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(shells_are_those_of_crystallography),
      cmocka_unit_test(chords_lead_from_site_to_site),
      cmocka_unit_test(coordinates_undo_places),
      cmocka_unit_test(one_lattice_is_the_hexagon),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
