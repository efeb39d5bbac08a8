/* A deck of a mesh with a crack, wrong in one place at a time, and the exact text that a user sees:
   bad_meshes/plate.nml, and a text for each fault. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/run/wrong_decks.h"

static const fault faults[] = {
    {"few_nodes", "support = 2.1", "support = 1.2", false},
    {"node_row", "0, '31 mm', '30 mm', '31 mm'", "0, '30 mm', '30 mm', '30 mm'", true},
    {"in_element", "0, '31 mm', '30 mm', '31 mm'", "0, '2 mm', '30 mm', '2 mm'", false},
    {"outside", "0, '31 mm', '30 mm'", "'-5 mm', '31 mm', '30 mm'", false},
    {"held_parameter", "'100 mm', '1 mm'", "'100 mm', '10 mm'", false},
    {"step", "end_time = '50 us'", "end_time = '50 us'  step = '2 us'", false},
    {"law_of_cracks", "'elastic'  E = '30 GPa'", "'lefm'", false},
    {"law_of_bonds", "'elastic'  E = '30 GPa'", "'pmb'", false},
    {"crack_of_a_body", "model = 'lefm'", "model = 'elastic'", false},
    {"no_toughness", "model = 'lefm'", "model = 'lefm'  K_Ic = 0", false},
    {"unit_of_toughness", "model = 'lefm'", "model = 'lefm'  K_Ic = '3 MPa'", false},
    {"not_linear", "'elastic'  E = '30 GPa'", "'stiffening'", false},
    {"traction_beside", "0, '60 mm'  to = '100 mm', '60 mm'", "0, '70 mm'  to = '1 m', '70 mm'",
     false},
    {"too_many_nodes", "nodes = 41, 25", "nodes = 20000, 20000", false},
    {"half_a_node", "nodes = 41, 25", "nodes = 41.5, 25", false},
    {"empty_zone", "corner = 0, 0  size = '100 mm', '3 mm'",
     "corner = '1 m', 0  size = '100 mm', '3 mm'", false},
    {"short_leg", "'30 mm', '31 mm'", "'30 mm', '31 mm', '30.5 mm', '31.5 mm'", true},
    {"wide_box", "half_size = 3", "half_size = 30", true},
    {"box_in_hole", "&tips ",
     "&notch mesh = 'plate' shape = 'disc' centre = '34 mm', '35 mm' radius = '3 mm' /\n&tips ",
     true},
    {"other_mesh", "'c'  mesh = 'plate'", "'c'  mesh = 'plat'", false},
    {"growth_at_rest", "&tips ", "&static /\n&tips ", false},
    {"growth_in_increments", "&tips ", "&relaxation increments = 3 /\n&tips ", false},
    {"traction_in_part", "0, '60 mm'  to = '100 mm', '60 mm'", "0, '60 mm'  to = '150 mm', '60 mm'",
     true},
    {"force_per_length", "&output ",
     "&region name = 'top' shape = 'segment' from = 0, '60 mm' to = '100 mm', '60 mm' /\n"
     "&force region = 'top' component = 'y' per_length = '1 kN/m' /\n&output ",
     false},
    {"begun_from_file", "&output ",
     "&region name = 'tip' shape = 'point' at = 0, '60 mm' /\n"
     "&initial_velocity region = 'tip' component = 'y' file = 'before.csv:v' /\n&output ",
     false},
    {"corner_alone", "check_steps = 10", "check_steps = 10  corner = 0, 0", false},
    {"size_alone", "check_steps = 10", "check_steps = 10  size = '90 mm', '60 mm'", false},
    {"tips_without_crack",
     "&crack     name = 'c'  mesh = 'plate'  points = 0, '31 mm', '30 mm', '31 mm'\n"
     "           grows = .true.  model = 'lefm' /\n",
     "", true},
    {"damped_backward", "&tips ", "&newmark beta_1 = 0.4 /\n&tips ", false},
};
enum { FAULTS = sizeof faults / sizeof *faults };

static void test_faults(void **state) {
  write_text(*state, "before.csv", "x [m],y [m],v [m/s]\n0,0.06,1\n0.1,0.06,1\n");
  check_faults(*state, SOURCE_DIR "/tests/generator/run/bad_meshes", "plate.nml", faults, FAULTS);
}

/* The size shows a wrong unit; a group that the deck leaves to the base material is told, no
   fault. */
static void test_file(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "$P check " SOURCE_DIR "/examples/plate_gmsh/plate.nml 2>&1"), 0);
  assert_non_null(strstr(w->said, "plate: 240 x 120 mm, "));
  assert_non_null(strstr(w->said, "; groups that the deck does not name: plate\n"));
  assert_null(strstr(w->said, "warning"));
}

/* K/G = 2(1 + nu)/(3(1 - 2 nu)) is 20 at nu = 0.4754. */
static void test_locking(void **state) {
  static const struct {
    const char *set;
    bool warns;
  } decks[] = {
      {"--set material.nu=0.48 --set mesh.dilatation=point", true},
      {"--set material.nu=0.48", false},
      {"--set material.nu=0.47 --set mesh.dilatation=point", false},
      {"--set material.nu=0.48 --set mesh.dilatation=point --set mesh.setting=plane_stress", false},
      {"--set material.nu=0.48 --set mesh.dilatation=point --set mesh.gauss=1", false}};
  workplace *w = *state;
  for (size_t k = 0; k < sizeof decks / sizeof *decks; k++) {
    char command[1000];
    snprintf(command, sizeof command,
             "$P check " SOURCE_DIR "/examples/thick_ring/ring.nml %s 2>&1", decks[k].set);
    assert_int_equal(shell(w, command), 0);
    const bool said = strstr(w->said, "its bulk modulus is 24.67 times the shear modulus") != NULL;
    if (said != decks[k].warns) print_message("%s\n%s", decks[k].set, w->said);
    assert_true(said == decks[k].warns);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_locking, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(test_file, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(test_faults, set_up_workplace, tear_down_workplace)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
