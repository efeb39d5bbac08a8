/* Particles of bars: where they stand, what is joined to what, masses and inertias; in the plane
   and in space, open and closed, with legs that the spacing divides and others. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "runtime/deck/lattice_kind.h"
#include "runtime/filling/bar_rows.h"
#include "tests/runtime/built_rows.h"

static const double area = 2e-4, rho = 7850; /* m^2, kg/m^3 */

static void build_bar(built_rows *b, const char *keys) {
  char text[1000];
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n&bar name = 'b' area = 2e-4 %s /\n"
           "&material bar = 'b' model = 'beam' /\n",
           keys);
  build_rows(b, text);
  rows_set_density(b->rows, rho);
}

static void stands_at(const rows *w, long particle, double x, double y, double z) {
  double at[3];
  rows_place(w, w->particle_site[particle], at);
  assert_true(fabs(at[0] - x) + fabs(at[1] - y) + fabs(at[2] - z) < 1e-15);
}

/* Of the bond between two particles, from either end; 0: there is none. */
static double joined(const rows *w, int32_t i, int32_t j) {
  rows_bond *bonds = rows_bonds(w);
  double length = 0;
  for (long k = 0; k < w->bond_count; k++)
    if ((bonds[k].i == i && bonds[k].j == j) || (bonds[k].i == j && bonds[k].j == i))
      length += w->list->length[bonds[k].slot];
  free(bonds);
  return length;
}

/* Each to the next, and no other. */
static void is_one_line(const rows *w, bool closed) {
  assert_int_equal(w->bond_count, w->particle_count - !closed);
  for (int32_t k = 0; k + 1 < w->particle_count; k++)
    assert_true(joined(w, k, k + 1) > 0);
  assert_true((joined(w, 0, (int32_t)w->particle_count - 1) > 0) == closed);
}

static double mass_of(const rows *w, long particle) {
  return w->site_mass[w->particle_site[particle]];
}

static double inertia_of(const rows *w, long particle) {
  const long site = w->particle_site[particle];
  return w->inertia * w->site_mass[site] / w->mass * rows_radius_square(w, site);
}

/* Mass rho A s and inertia (2/5) m (s/2)^2 of each, the ends too. */
static void a_straight_bar(void **state) {
  (void)state;
  built_rows b;
  build_bar(&b, "points = 0.1, 0.2, 0.7, 1.0  spacing = 0.02");
  const rows *w = b.rows;
  assert_int_equal(w->particle_count, 51);
  is_one_line(w, false);
  for (int k = 0; k <= 50; k++) {
    stands_at(w, k, 0.1 + 0.012 * k, 0.2 + 0.016 * k, 0);
    assert_true(fabs(mass_of(w, k) / (rho * area * 0.02) - 1) < 1e-14);
    assert_true(fabs(inertia_of(w, k) / (0.4 * mass_of(w, k) * 1e-4) - 1) < 1e-13);
  }
  assert_true(fabs(joined(w, 7, 8) / 0.02 - 1) < 1e-13);
  assert_true(w->area == area && fabs(w->spacing / 0.02 - 1) < 1e-14 && w->site_area == 0);
  built_end(&b);
}

/* A leg of 104 mm has parts of 10.4 mm beside those of 10 mm; a corner particle has half of each.
   */
static void legs_are_divided_evenly(void **state) {
  (void)state;
  built_rows b;
  build_bar(&b, "points = 0, 0, 0, 0.104, 0.2, 0.104  spacing = 0.01");
  const rows *w = b.rows;
  const double mean = (10 * 0.0104 + 0.0102 + 20 * 0.01) / 31;
  assert_int_equal(w->particle_count, 31);
  is_one_line(w, false);
  stands_at(w, 0, 0, 0, 0);
  stands_at(w, 5, 0, 0.052, 0);
  stands_at(w, 10, 0, 0.104, 0);
  stands_at(w, 30, 0.2, 0.104, 0);
  assert_true(fabs(mass_of(w, 0) / (rho * area * 0.0104) - 1) < 1e-13);
  assert_true(fabs(mass_of(w, 10) / (rho * area * 0.0102) - 1) < 1e-13);
  assert_true(fabs(mass_of(w, 30) / (rho * area * 0.01) - 1) < 1e-13);
  assert_true(fabs(inertia_of(w, 0) / (0.1 * mass_of(w, 0) * 0.0104 * 0.0104) - 1) < 1e-13);
  assert_true(fabs(inertia_of(w, 30) / (0.1 * mass_of(w, 30) * 0.01 * 0.01) - 1) < 1e-13);
  assert_true(fabs(joined(w, 3, 4) - 0.0104) < 1e-15 && fabs(joined(w, 13, 14) - 0.01) < 1e-15);
  assert_true(fabs(w->spacing / mean - 1) < 1e-13);
  built_end(&b);
}

static void a_stirrup_is_closed(void **state) {
  (void)state;
  built_rows b;
  build_bar(&b, "points = 0, 0, 0.2, 0, 0.2, 0.1, 0, 0.1  closed = .true.  spacing = 0.02");
  const rows *w = b.rows;
  assert_int_equal(w->particle_count, 30);
  is_one_line(w, true);
  stands_at(w, 10, 0.2, 0, 0);
  stands_at(w, 29, 0, 0.02, 0);
  for (int k = 0; k < 30; k++)
    assert_true(fabs(mass_of(w, k) / (rho * area * 0.02) - 1) < 1e-13);
  built_end(&b);
}

/* Copy after copy, each as the line alone but for its place, and none joined to another. */
static void copies_are_lines_of_their_own(void **state) {
  (void)state;
  static const struct {
    const char *line, *shift;
    double by[3];
    int copies;
  } bars[] = {
      {"points = 0, 0, 0, 0.104, 0.2, 0.104 spacing = 0.01", "0.03, -0.01", {0.03, -0.01}, 4},
      {"points = 0, 0, 0.2, 0, 0.2, 0.1, 0, 0.1 closed = T spacing = 0.02", "0.08, 0", {0.08}, 15},
      {"points = 0, 0, 0, 0, 0.1, 0, 0, 0.1, 0.1 closed = T spacing = 0.013 setting = 'space'",
       "0.05, 0, 0.002",
       {0.05, 0, 0.002},
       3}};
  for (int n = 0; n < 3; n++) {
    built_rows one, all;
    char text[256];
    build_bar(&one, bars[n].line);
    snprintf(text, sizeof text, "%s copies = %d shift = %s", bars[n].line, bars[n].copies,
             bars[n].shift);
    build_bar(&all, text);
    const rows *v = one.rows, *w = all.rows;
    const int32_t each = (int32_t)v->particle_count;
    assert_int_equal(w->particle_count, bars[n].copies * each);
    assert_int_equal(w->bond_count, bars[n].copies * v->bond_count);
    assert_true(fabs(w->spacing / v->spacing - 1) < 1e-13);
    for (int32_t p = 0; p < w->particle_count; p++) {
      const int32_t copy = p / each, same = p % each, next = (same + 1) % each;
      double at[3];
      rows_place(v, v->particle_site[same], at);
      stands_at(w, p, at[0] + copy * bars[n].by[0], at[1] + copy * bars[n].by[1],
                at[2] + copy * bars[n].by[2]);
      assert_true(fabs(mass_of(w, p) / mass_of(v, same) - 1) < 1e-14);
      assert_true(fabs(inertia_of(w, p) / inertia_of(v, same) - 1) < 1e-13);
      assert_true(fabs(joined(w, p, copy * each + next) - joined(v, same, next)) < 1e-15);
    }
    built_end(&one);
    built_end(&all);
  }
}

/* Bars of a deck move where its lattices do; alone they say so. */
static void bars_in_space(void **state) {
  (void)state;
  built_rows b;
  build_bar(&b, "points = 0, 0, 0, 0.1, 0, 0, 0.1, 0.03, 0.04  setting = 'space'  spacing = 0.01");
  assert_int_equal(b.rows->dimensions, 3);
  assert_int_equal(b.rows->particle_count, 16);
  is_one_line(b.rows, false);
  stands_at(b.rows, 12, 0.1, 0.012, 0.016);
  assert_true(b.rows->stiffness_thickness == 0 && b.rows->area == area);
  built_end(&b);
  read_deck(&b, "&simulation end_time = 1 /\n"
                "&bar name = 'b' area = 0.01 points = 6*0, 1, 1, 1 spacing = 0.1 /\n"
                "&bar name = 'c' diameter = 0.2 points = 3*0, 1, 1, 1 spacing = 0.1 /\n"
                "&lattice name = 'a' kind = 'cubic' spacing = 1 /\n"
                "&body lattice = 'a' shape = 'sphere' centre = 3*0 radius = 2 /\n"
                "&material lattice = 'a' model = 'lps' /\n&material bar = 'c' model = 'beam' /\n"
                "&material bar = 'b' model = 'beam' /\n");
  assert_null(b.deck);
  assert_int_equal(b.said.errors, 1); /* two points of `b` are the same */
  built_end(&b);
}

static void a_diameter_gives_the_area(void **state) {
  (void)state;
  built_rows b;
  read_deck(&b, "&simulation end_time = 1 /\n&material bar = 'b' model = 'beam' /\n"
                "&bar name = 'b' diameter = '12.7 mm' points = 2*0, 2*1 spacing = 0.1 /\n");
  assert_non_null(b.deck);
  assert_int_equal(b.deck->lattice_count, 1);
  assert_true(deck_lattice_is_bar(&b.deck->lattices[0]));
  assert_true(fabs(b.deck->lattices[0].area / 126.67686977437442e-6 - 1) < 1e-14);
  built_end(&b);
}

static void a_straight_one_of_the_same_bar(void **state) {
  (void)state;
  built_rows b;
  build_bar(&b, "points = 0, 0, 0, 0.104, 0.2, 0.104  spacing = 0.01");
  rows *w = bar_rows_straight(b.rows, 9);
  assert_int_equal(w->particle_count, 9);
  is_one_line(w, false);
  stands_at(w, 8, 8 * b.rows->spacing, 0, 0);
  assert_true(w->area == area && fabs(w->spacing / b.rows->spacing - 1) < 1e-14);
  rows_free(w);
  built_end(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_straight_bar),
      cmocka_unit_test(legs_are_divided_evenly),
      cmocka_unit_test(a_stirrup_is_closed),
      cmocka_unit_test(copies_are_lines_of_their_own),
      cmocka_unit_test(bars_in_space),
      cmocka_unit_test(a_diameter_gives_the_area),
      cmocka_unit_test(a_straight_one_of_the_same_bar),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
