/* A periodic piece of a lattice: where its sites stand, what they repeat, and what a law says on
   it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "runtime/analysis/implied.h"
#include "runtime/analysis/patch.h"
#include "tests/runtime/family_law.h"

static const double spacing = 0.01;

static rows *lattice_of(const char *kind, int shells) {
  const bool space = bravais_dimensions(kind) == 3;
  const double t = space ? 0 : 0.1;
  return implied_lattice_like(&(deck_lattice){.kind = kind,
                                              .spacing = spacing,
                                              .shells = shells,
                                              .rotation = 0.2,
                                              .thickness = t,
                                              .stiffness_thickness = t,
                                              .mass_thickness = t,
                                              .setting = space ? "space" : "plane_stress"},
                              2323);
}

static patch *patch_of(const rows *w, const long period[3]) {
  double parameters[FAMILY_PARAMETERS];
  for (int p = 0; p < FAMILY_PARAMETERS; p++)
    parameters[p] = family_parameters[p].initial;
  return patch_new(&family_hexagon, parameters, w, period, 0, 0);
}

/* The chord leads from a site to its neighbour, or to an image of it whole periods away. */
static void neighbours_stand_a_chord_away(void **state) {
  (void)state;
  const long period[3] = {3, 4, 1};
  rows *w = lattice_of("hexagonal", 2);
  patch *p = patch_of(w, period);
  assert_int_equal(p->inside_count, 12);
  for (long q = 0; q < p->inside_count; q++)
    for (int k = 0; k < 2 * w->directions; k++) {
      const long site = p->inside[q], far = site + p->offset[k];
      const pl_bond_class c = rows_bond_class(w, k);
      double here[3], there[3];
      patch_position(p, site, here);
      patch_position(p, far, there);
      for (int d = 0; d < 2; d++)
        assert_true(fabs(there[d] - here[d] - c.chord[d]) < 1e-12 * spacing);
      assert_int_equal(patch_neighbour(p, site, k), p->image[far]);
      assert_int_equal(p->image[p->image[far]], p->image[far]);
    }
  patch_free(p);
  rows_free(w);
}

static void a_cut_bond_is_gone_from_both_sides(void **state) {
  (void)state;
  const long period[3] = {4, 4, 1};
  rows *w = lattice_of("hexagonal", 1);
  patch *p = patch_of(w, period);
  for (int k = 0; k < 6; k++) {
    const long site = p->inside[3], far = patch_neighbour(p, site, k);
    assert_true(patch_has_bond(p, site, k));
    patch_cut(p, site, k);
    assert_false(patch_has_bond(p, site, k));
    assert_false(patch_has_bond(p, far, (k + 3) % 6));
  }
  int left = 0;
  for (long q = 0; q < p->inside_count; q++)
    for (int k = 0; k < 6; k++)
      left += patch_has_bond(p, p->inside[q], k);
  assert_int_equal(left, 6 * 16 - 12);
  patch_free(p);
  rows_free(w);
}

/* A uniform strain leaves every particle of a perfect lattice in balance; one that moves has the
   others push back. */
static void forces_are_those_of_the_periodic_lattice(void **state) {
  (void)state;
  const long period[3] = {4, 4, 1};
  const double strain[3][3] = {{1e-3, 4e-4}, {4e-4, -5e-4}}, none[3][3] = {{0}};
  rows *w = lattice_of("hexagonal", 1);
  patch *p = patch_of(w, period);
  patch_deform(p, strain, NULL, p->displacement);
  patch_step(p);
  for (long q = 0; q < p->inside_count; q++)
    for (int d = 0; d < 2; d++)
      assert_true(fabs(p->force[d][p->inside[q]]) < 1e-4); /* bonds carry tens of kN */
  double *part[2] = {calloc((size_t)p->sites, sizeof(double)),
                     calloc((size_t)p->sites, sizeof(double))};
  part[0][p->inside[5]] = 1e-3 * spacing;
  patch_deform(p, none, part, p->displacement);
  patch_step(p);
  double sum[2] = {0, 0};
  for (long q = 0; q < p->inside_count; q++)
    for (int d = 0; d < 2; d++)
      sum[d] += p->force[d][p->inside[q]];
  assert_true(p->force[0][p->inside[5]] < -1e3);
  assert_true(fabs(sum[0]) < 1e-6 && fabs(sum[1]) < 1e-6);
  free(part[0]);
  free(part[1]);
  patch_free(p);
  rows_free(w);
}

/* A field on neighbours keeps what each side saw; accepted, it is at hand. */
static void new_fields_are_taken_over(void **state) {
  (void)state;
  const long period[3] = {2, 2, 1};
  const double strain[3][3] = {{2e-3, 0}, {0, 0}};
  rows *w = lattice_of("hexagonal", 1);
  patch *p = patch_of(w, period);
  patch_deform(p, strain, NULL, p->displacement);
  patch_step(p);
  assert_true(p->field[1][p->inside[0]] == family_fields[1].initial);
  patch_accept(p);
  double largest = -1;
  for (int k = 0; k < 6; k++)
    largest = fmax(largest, p->field[1][k * p->size + p->inside[0]]);
  assert_true(largest > 1.5e-3 && largest < 2.1e-3);
  for (long q = 0; q < p->sites; q++)
    assert_true(p->field[1][q] == p->field[1][p->image[q]]);
  patch_virgin(p);
  assert_true(p->field[1][p->inside[0]] == family_fields[1].initial);
  patch_free(p);
  rows_free(w);
}

/* fcc: 18 neighbours; sites of a period fill it once. */
static void lattices_in_space_repeat_too(void **state) {
  (void)state;
  rows *w = lattice_of("fcc", 2);
  long margin[3];
  patch_margins(&family_hexagon, w, margin);
  for (int n = 0; n < 3; n++)
    assert_true(margin[n] >= 1);
  assert_int_equal(2 * w->directions, 18);
  assert_true(fabs(w->volume - spacing * spacing * spacing / sqrt(2)) < 1e-12 * w->volume);
  rows_free(w);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(neighbours_stand_a_chord_away),
      cmocka_unit_test(a_cut_bond_is_gone_from_both_sides),
      cmocka_unit_test(forces_are_those_of_the_periodic_lattice),
      cmocka_unit_test(new_fields_are_taken_over),
      cmocka_unit_test(lattices_in_space_repeat_too),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
