/* The beams of examples/reinforced_concrete with a bar off the sites of the lattice (Gerstle et al.
   2013, sections 5.4 to 5.6): loads that they bear, and that they do not. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/held_load.h"

/* Reference: 42 to 46. */
static void one_bar_off_sites(void **state) {
  (void)state;
  static const char off[] = "bar.points=-0.60 m, 20 mm, 0.60 m, 20 mm";
  assert_true(bears_with("one_bar", -54 * 1.2, 10.85e-3, off));
  assert_false(bears_with("one_bar", -58 * 1.2, 10.85e-3, off));
  page_says("With the one bar at y = 20 mm", "bears 54 kN/m and breaks at 58");
}

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
  const struct CMUnitTest tests[] = {cmocka_unit_test(one_bar_off_sites), cmocka_unit_test(bending),
                                     cmocka_unit_test(shear)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
