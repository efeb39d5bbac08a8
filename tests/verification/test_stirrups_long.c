/* The beams of examples/reinforced_concrete with a bar off the sites of the lattice (Gerstle et al.
   2013, sections 5.4 to 5.6): loads that they bear, and that they do not. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/held_load.h"

#define OFF_SITES "bar[bottom].points=-0.60 m, 20 mm, 0.60 m, 20 mm"
#define LASTING   "material[concrete].damper=lasting"

/* kN/m: a load that the beam bears, and the next one, which it does not. */
static void strength(const char *deck_name, double borne, double not_borne, const char *more,
                     const char *again) {
  assert_true(bears_with(deck_name, -1.2 * borne, 10.85e-3, more, again));
  assert_false(bears_with(deck_name, -1.2 * not_borne, 10.85e-3, more, again));
}

/* Reference: 42 to 46. */
static void one_bar_off_sites(void **state) {
  (void)state;
  strength("one_bar", 44, 50, OFF_SITES, NULL);
  page_says("| 5.4 one bar, off", "| 44, 46 kN/m |");
}

/* Reference: 65 to 70. */
static void bending(void **state) {
  (void)state;
  strength("stirrups_bending", 68, 72, NULL, NULL);
  page_says("| 5.5 stirrups, bending", "| 68, 72 kN/m |");
}

/* Reference: 250 to 270. */
static void shear(void **state) {
  (void)state;
  strength("stirrups_shear", 270, 280, NULL, NULL);
  page_says("| 5.6 stirrups, shear", "| 270, 280 kN/m |");
}

/* Where torn bonds keep their dampers, as eq 18 is printed. */
static void dampers_that_last(void **state) {
  (void)state;
  strength("one_bar", 84, 86, LASTING, NULL);
  page_says("| 5.4 one bar, on", "| 84, 86 |");
  strength("one_bar", 54, 58, OFF_SITES, LASTING);
  page_says("| 5.4 one bar, off", "| 54, 58 |");
  strength("stirrups_bending", 72, 76, LASTING, NULL);
  page_says("| 5.5 stirrups, bending", "| 72, 76 |");
  strength("stirrups_shear", 300, 320, LASTING, NULL);
  page_says("| 5.6 stirrups, shear", "| 300, 320 |");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(one_bar_off_sites), cmocka_unit_test(bending),
                                     cmocka_unit_test(shear),
                                     cmocka_unit_test(dampers_that_last)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
