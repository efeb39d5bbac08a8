/* The cases of test_family_cases at the spacings of examples/, the beam in space a little coarser.
   */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/family_cases.h"

static void a_cube_has_the_constants_of_the_solid(void **state) {
  (void)state;
  check_cube("lattice.spacing=5 mm");
}

static void pulses_travel_along_a_bar(void **state) {
  (void)state;
  check_pulses(
      (const char *const[]){"lattice.spacing=1.25 mm", "lattice.origin=0.625 mm, 0.625 mm"},
      (const char *const[]){"lattice.spacing=0.625 mm", "lattice.origin=0.3125 mm, 0.3125 mm"},
      0.025);
}

static void a_crack_runs_below_the_rayleigh_speed(void **state) {
  (void)state;
  check_crack((const char *const[]){"lattice.spacing=0.5 mm", "lattice.origin=0, 0.25 mm"});
}

static void a_beam_in_space_breaks(void **state) {
  (void)state;
  check_beam("lattice.spacing=4 mm");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_cube_has_the_constants_of_the_solid),
      cmocka_unit_test(pulses_travel_along_a_bar),
      cmocka_unit_test(a_crack_runs_below_the_rayleigh_speed),
      cmocka_unit_test(a_beam_in_space_breaks),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
