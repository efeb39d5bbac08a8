/* Kinds of lattices: what follows from a name, and the lattice that is meant where none is named.
   */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/deck/bravais.h"
#include "runtime/deck/lattice_kind.h"

static int half_family(const deck_lattice *l) {
  bravais_neighbour list[PL_MAX_DIRECTIONS];
  bravais b;
  assert_true(bravais_of(l, &b));
  return bravais_family(&b, l->horizon, l->shells, list);
}

/* The volume of a site's cell: rows and layers are as far apart as the steps say. */
static void every_kind_is_one_of_sites_or_of_none(void **state) {
  (void)state;
  static const struct {
    const char *name;
    int dimensions, neighbours;
    double measure; /* of a site, in spacings */
  } known[] = {{"hexagonal", 2, 6, 0.86602540378443865},
               {"square", 2, 4, 1},
               {"chain", 2, 2, 1},
               {"cubic", 3, 6, 1},
               {"fcc", 3, 12, 0.70710678118654752}};
  int sites = 0;
  for (int k = 0; k < LATTICE_KIND_COUNT; k++) {
    const deck_lattice l = {.kind = lattice_kinds[k].name, .spacing = 1};
    assert_ptr_equal(lattice_kind_find(lattice_kinds[k].name), &lattice_kinds[k]);
    assert_true((strstr(LATTICE_KIND_CHOICES, l.kind) == NULL) ==
                (deck_lattice_is_bar(&l) || deck_lattice_is_link(&l) || deck_lattice_is_mesh(&l)));
    assert_true(deck_lattice_is_irregular(&l) == (lattice_kinds[k].dimensions == 0));
    const bool has_sites = !deck_lattice_is_irregular(&l) && !deck_lattice_is_mesh(&l);
    assert_true((strstr(LATTICE_KINDS_OF_SITES, l.kind) != NULL) == has_sites);
    sites += has_sites;
  }
  assert_int_equal(sites, sizeof known / sizeof *known);
  for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
    const deck_lattice l = {.kind = known[k].name, .spacing = 1};
    bravais b;
    assert_true(bravais_of(&l, &b));
    assert_true(deck_lattice_is_chain(&l) == (known[k].neighbours == 2));
    assert_int_equal(deck_lattice_dimensions(&l), known[k].dimensions);
    assert_int_equal(2 * half_family(&l), known[k].neighbours);
    assert_true(fabs(b.site_measure - known[k].measure) < 1e-15);
  }
  assert_null(lattice_kind_find("hexagon"));
}

static void without_sites_the_setting_says_the_dimensions(void **state) {
  (void)state;
  bravais b;
  deck_lattice l = {.kind = "blue_noise", .spacing = 1, .setting = "plane_strain"};
  assert_int_equal(deck_lattice_dimensions(&l), 2);
  l.setting = NULL;
  assert_int_equal(deck_lattice_dimensions(&l), 2);
  l.setting = "space";
  assert_int_equal(deck_lattice_dimensions(&l), 3);
  assert_false(bravais_of(&l, &b));
  l.kind = "fcc";
  l.setting = "plane_stress"; /* a kind with sites is what it is */
  assert_int_equal(deck_lattice_dimensions(&l), 3);
  l.kind = "none";
  assert_int_equal(deck_lattice_dimensions(&l), 0);
  assert_false(deck_lattice_is_irregular(&l));
}

static void the_lattice_that_is_meant(void **state) {
  (void)state;
  const deck_lattice plane = lattice_default("plane_strain", 2e-3, 0.1);
  const deck_lattice space = lattice_default("space", 5e-3, 0.1);
  assert_true(bravais_is_hexagon(&plane));
  assert_int_equal(2 * half_family(&plane), 6);
  assert_true(plane.thickness == 0.1 && plane.mass_thickness == 0.1 &&
              plane.stiffness_thickness == 0.1);
  assert_string_equal(plane.setting, "plane_strain");
  assert_int_equal(2 * half_family(&space), 18); /* 12 at the spacing, 6 at its sqrt(2) */
  assert_false(bravais_is_hexagon(&space));
  assert_true(space.spacing == 5e-3 && space.thickness == 0 && space.mass_thickness == 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_kind_is_one_of_sites_or_of_none),
      cmocka_unit_test(without_sites_the_setting_says_the_dimensions),
      cmocka_unit_test(the_lattice_that_is_meant)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
