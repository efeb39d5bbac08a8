/* The larger dog-bone on finite elements, beside the lattice and theory. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/beside.h"
#include "tests/verification/cohesive_neck.h"

/* The stress at the sides of the neck is above the mean, and the crack begins there while the
   middle is sound: less than the strength of all of the neck, as of a cohesive crack. */
static void the_larger_dog_bone(void **state) {
  (void)state;
  const double theory = 57.96e3,
               brittle = beside_check(
                   &(beside){"dog_bone", "d_brittle", "10.4 ms", theory, 0.9, 0.98, NULL}),
               plastic = beside_check(
                   &(beside){"dog_bone", "d_continuum", "10.8 ms", theory, 0.9, 0.98, NULL});
  assert_true(fabs(brittle / plastic - 1) < 0.03);
  const double two_lines = brittle / theory - cohesive_dog_bone(0.4, 85.57, false),
               softly = plastic / theory - cohesive_dog_bone(0.4, 85.57, true);
  assert_true(two_lines > 0 && two_lines < 0.01 && softly > 0 && softly < 0.016);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_larger_dog_bone),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
