/* The same at half the spacing and the same horizon, where the lattice turns the crack less. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/crack_path.h"

static void the_path_depends_less_on_a_fine_lattice(void **state) {
  (void)state;
  const char *const turned[] = {"lattice.rotation=30",    "lattice.origin=0.125 mm, 0.25 mm",
                                "lattice.spacing=0.5 mm", "lattice.horizon=6.03",
                                "protect[1].radius=6.03", "protect[2].radius=6.03",
                                "simulation.step=0.05 us"};
  check_angle("examples/kalthoff/hexagon.nml", turned, sizeof turned / sizeof *turned, 67.3);
}

static void angles_have_error_bars(void **state) {
  (void)state;
  static const double spacings[] = {1, 0.75, 0.6};
  for (int kind = 0; kind < 3; kind++)
    for (int k = 0; k < 3; k++)
      check_plates(&all_plates[kind], spacings[k]);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_path_depends_less_on_a_fine_lattice),
                                     cmocka_unit_test(angles_have_error_bars)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
