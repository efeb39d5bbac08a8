/* The beams with stirrups of examples/reinforced_concrete (Gerstle et al. 2013, sections 5.5 and
   5.6): loads that they bear, and that they do not. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/held_load.h"

/* Reference: 65 to 70. */
static void bending(void **state) {
  (void)state;
  assert_true(bears("stirrups_bending", -72 * 1.2, 10.85e-3));
  assert_false(bears("stirrups_bending", -76 * 1.2, 10.85e-3));
  page_says("| 5.5 stirrups, bending", "| 72, 76 kN/m |");
}

/* Reference: 250 to 270. */
static void shear(void **state) {
  (void)state;
  assert_true(bears("stirrups_shear", -300 * 1.2, 10.85e-3));
  assert_false(bears("stirrups_shear", -320 * 1.2, 10.85e-3));
  page_says("| 5.6 stirrups, shear", "| 300, 320 kN/m |");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(bending), cmocka_unit_test(shear)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
