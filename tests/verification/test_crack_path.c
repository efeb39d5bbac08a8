/* The angle of the crack in Kalthoff and Winkler's plate has the figures that examples/kalthoff and
   models/README.md print: the lattice turns it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/crack_path.h"

static void turned(const char *name, const char *rotation, double expected) {
  check_angle(name, &rotation, 1, expected);
}

static void the_path_depends_on_the_lattice(void **state) {
  (void)state;
  turned("examples/kalthoff/square.nml", "lattice.rotation=0", 60.9);
  turned("examples/kalthoff/square.nml", "lattice.rotation=45", 65.3);
  turned("examples/kalthoff/hexagon.nml", "lattice.rotation=0", 63.9);
  turned("examples/kalthoff/hexagon.nml", "lattice.rotation=30", 69.8);
}

/* Blue noise alone: the lattices are in test_crack_path_long. */
static void the_angle_has_an_error_bar(void **state) {
  (void)state;
  check_plates(&all_plates[2], 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_path_depends_on_the_lattice),
                                     cmocka_unit_test(the_angle_has_an_error_bar)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
