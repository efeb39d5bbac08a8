/* A deck of a plate and a stamp, wrong in one place at a time, and the exact text that a user sees:
   bad_stamps/plate.nml, and a text for each fault. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/run/wrong_decks.h"

#define BODY_OF_PLATE                                                                              \
  "  E = '30 GPa'  nu = 0.2  rho = '2323 kg/m^3'  /\n"                                             \
  "&body        lattice = 'plate'  shape = 'rectangle'  corner = 0, 0  size = '0.1 m', "

static const fault faults[] = {
    {"inside", "'0.12 m'", "'0.1 m'", false},
    {"by_a_little", "'0.12 m'", "'0.115 m'", false},
    {"coarse",
     "'hexagonal'  spacing = '5 mm'  thickness = '10 mm'  /\n"
     "&material    lattice = 'plate'  model = 'elastic_micropolar'" BODY_OF_PLATE "'0.1 m'",
     "'blue_noise'  spacing = '4 [mm] + 0.1*y'  thickness = '10 mm'  /\n"
     "&material    lattice = 'plate'  model = 'splm_elastic'" BODY_OF_PLATE "'0.11 m'",
     false},
    {"mesh", "  lattices = 'plate'", "", false},
    {"mesh_named", "lattices = 'plate'", "lattices = 'rim'", false},
    {"too_fast", "'50 m/s'", "'50 km/s'", false},
    {"quasi_static", "&output ", "&relaxation  increments = 2  /\n&output ", false},
    {"no_stiffness", "lattices = 'plate'", "lattices = 'plate'  stiffness = 0", false},
    {"jump", "mass = '0.2 kg'  direction = 0, -1  velocity = '50 m/s'",
     "direction = 0, -1  displacement = '1 mm'", true},
};
enum { FAULTS = sizeof faults / sizeof *faults };

static void test_faults(void **state) {
  check_faults(*state, SOURCE_DIR "/tests/generator/run/bad_stamps", "plate.nml", faults, FAULTS);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_faults, set_up_workplace, tear_down_workplace)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
