/* A deck of a lattice between two meshes, wrong in one place at a time, and the exact text that a
   user sees: bad_ties/strip.nml, and a text for each fault. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/run/wrong_decks.h"

static const fault faults[] = {
    {"nothing_in_mesh", "corner = '-40 mm', 0", "corner = '-60 mm', 0", false},
    {"all_in_mesh", "corner = '-40 mm', 0  size = '40 mm', '40 mm'",
     "corner = '-40 mm', '-1 mm'  size = '100 mm', '50 mm'", false},
    {"element_free",
     "size = '40 mm', '40 mm'  nodes = 5, 5  thickness = '10 mm'\n           method = "
     "'finite_elements'",
     "size = '40 mm', '40 mm'  nodes = 5, 5  thickness = '10 mm'\n           method = "
     "'element_free'",
     false},
    {"two_meshes", "corner = '43.30127 mm', 0  size", "corner = '-20 mm', 0  size", false},
    {"held", "name = 'end'  lattice = 'left'  shape = 'rectangle'  corner = '-41 mm', 0",
     "name = 'end'  lattice = 'core'  shape = 'rectangle'  corner = '-1 mm', 0", false},
    {"driven",
     "name = 'end'  lattice = 'left'  shape = 'rectangle'  corner = '-41 mm', 0  size = '2 mm', "
     "'40 mm' "
     "/\n&support   region = 'end'  fix = 'x', 'y'",
     "name = 'end'  lattice = 'core'  shape = 'rectangle'  corner = '-1 mm', 0  size = '2 mm', '40 "
     "mm' "
     "/\n&drive   region = 'end'  component = 'x' velocity = 1",
     false},
    {"loaded",
     "name = 'end'  lattice = 'left'  shape = 'rectangle'  corner = '-41 mm', 0  size = '2 mm', "
     "'40 mm' "
     "/\n&support   region = 'end'  fix = 'x', 'y'",
     "name = 'end'  lattice = 'core'  shape = 'rectangle'  corner = '-1 mm', 0  size = '2 mm', '40 "
     "mm' "
     "/\n&force   region = 'end'  component = 'x' total = 1",
     false},
    {"thinner", "thickness = '10 mm'  rotation", "thickness = '12 mm'  rotation", true},
    {"plane_strain", "'10 mm'  rotation", "'10 mm'  setting = 'plane_strain'  rotation", true},
    {"softer", "'right'  model = 'elastic'  E = '30 GPa'",
     "'right'  model = 'elastic'  E = '28 GPa'", true},
    {"families", "'elastic_micropolar'  E = '30 GPa'  nu = 0.2", "'lps'  E = '30 GPa'  nu = 0.2",
     false},
    {"to_itself", "lattice = 'core'  mesh = 'left'", "lattice = 'left'  mesh = 'left'", false},
    {"no_mesh", "lattice = 'core'  mesh = 'left'", "lattice = 'core'  mesh = 'core'", false},
    {"twice", "mesh = 'right' /\n\n", "mesh = 'left' /\n\n", false},
    {"beside", "'43.30127 mm', '40 mm'", "'39 mm', '40 mm'", false},
    {"zigzag", "rotation = 90", "rotation = 0", false},
    {"over_the_edge", "corner = '43.30127 mm', 0  size", "corner = '41 mm', 0  size", true},
    {"linked", "&output ",
     "&bar  name = 'rebar'  points = 0, '21 mm', '43 mm', '21 mm'  diameter = '5 mm'  spacing = "
     "'8.6 mm' /\n&material  bar = 'rebar'  model = 'steel_bar'  E = '200 GPa'  F_y = '400 MPa'  "
     "rho = '7850 kg/m^3' /\n&link  name = 'bond'  bar = 'rebar'  lattice = 'core' /\n&material  "
     "link = 'bond'  model = 'bar_bond'  E = '25 GPa'  nu = 0.2  rho = '2323 kg/m^3' /\n&output ",
     false},
    {"static", "&output ", "&static /\n&output ", false},
};
enum { FAULTS = sizeof faults / sizeof *faults };

static void test_faults(void **state) {
  check_faults(*state, SOURCE_DIR "/tests/generator/run/bad_ties", "strip.nml", faults, FAULTS);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_faults, set_up_workplace, tear_down_workplace)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
