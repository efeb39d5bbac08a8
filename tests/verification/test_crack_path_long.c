/* The same at half the spacing and the same horizon, where the lattice turns the crack less. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/crack_path.h"

static void fine(const char *name, const char *rotation, const char *origin, double expected) {
  const char *const overrides[] = {rotation,
                                   origin,
                                   "lattice.spacing=0.5 mm",
                                   "simulation.step=0.05 us",
                                   "lattice.horizon=6.03",
                                   "protect[1].radius=6.03",
                                   "protect[2].radius=6.03"};
  check_angle(name, overrides, sizeof overrides / sizeof *overrides, expected);
}

static void the_path_depends_less_on_a_fine_lattice(void **state) {
  (void)state;
  fine("examples/kalthoff/square.nml", "lattice.rotation=45", "lattice.origin=0.25 mm, 0.25 mm",
       61.8);
  fine("examples/kalthoff/hexagon.nml", "lattice.rotation=30", "lattice.origin=0.125 mm, 0.25 mm",
       67.3);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_path_depends_less_on_a_fine_lattice)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
