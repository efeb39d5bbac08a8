/* The beams of examples/reinforced_concrete with a bar off the sites of the lattice (Gerstle et al.
   2013, sections 5.4 to 5.6): loads that they bear, and that they do not, as printed and where torn
   bonds have no damper; what their twins by displacement carry. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/held_load.h"

#define OFF_SITES "bar[bottom].points=-0.60 m, 20 mm, 0.60 m, 20 mm"
#define BREAKING  "material[concrete].damper=breaking"

/* kN/m: a load that the beam bears, and the next one, which it does not. */
static void strength(const char *deck_name, double borne, double not_borne, const char *more,
                     const char *again) {
  assert_true(bears_with(deck_name, -1.2 * borne, 10.85e-3, more, again));
  assert_false(bears_with(deck_name, -1.2 * not_borne, 10.85e-3, more, again));
}

/* Reference: 42 to 46. */
static void one_bar_off_sites(void **state) {
  (void)state;
  strength("one_bar", 54, 58, OFF_SITES, NULL);
  page_says("| 5.4 one bar, off", "| 54, 58 kN/m |");
}

/* Reference: 65 to 70. */
static void bending(void **state) {
  (void)state;
  strength("stirrups_bending", 72, 76, NULL, NULL);
  page_says("| 5.5 stirrups, bending", "| 72, 76 kN/m |");
}

/* Reference: 250 to 270. */
static void shear(void **state) {
  (void)state;
  strength("stirrups_shear", 300, 320, NULL, NULL);
  page_says("| 5.6 stirrups, shear", "| 300, 320 kN/m |");
}

/* Where torn bonds have no damper: the reference. */
static void without_dampers_of_torn_bonds(void **state) {
  (void)state;
  strength("plain_beam", 42, 43, BREAKING, NULL);
  page_says("| 5.3 plain beam", "| 42, 43 |");
  strength("one_bar", 82, 84, BREAKING, NULL);
  page_says("| 5.4 one bar, on", "| 82, 84 |");
  strength("one_bar", 46, 48, OFF_SITES, BREAKING);
  page_says("| 5.4 one bar, off", "| 46, 48 |");
  strength("stirrups_bending", 68, 72, BREAKING, NULL);
  page_says("| 5.5 stirrups, bending", "| 68, 72 |");
  strength("stirrups_shear", 270, 280, BREAKING, NULL);
  page_says("| 5.6 stirrups, shear", "| 270, 280 |");
}

static void twins_by_displacement(void **state) {
  (void)state;
  carries("one_bar_path", NULL, "| 5.4 one bar, on", "| %.1f kN,", 0.5);
  carries("one_bar_path", OFF_SITES, "| 5.4 one bar, off", "| %.1f kN,", 0.5);
  carries("stirrups_bending_path", NULL, "| 5.5 stirrups, bending", "| %.1f kN,", 1); /* yields */
  carries("stirrups_shear_path", NULL, "| 5.6 stirrups, shear", "| %.1f kN,", 0.9);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(one_bar_off_sites), cmocka_unit_test(bending), cmocka_unit_test(shear),
      cmocka_unit_test(without_dampers_of_torn_bonds), cmocka_unit_test(twins_by_displacement)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
