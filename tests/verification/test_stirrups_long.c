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
#define LASTING   "material[concrete].damper=lasting"
#define LONG_STEP "simulation.step_safety=0.8"
#define LIST(...) ((const char *[]){__VA_ARGS__, NULL})

/* kN/m: a load that the beam bears, and the next one, which it does not; the page says so. */
static void strength(const char *deck_name, double borne, double not_borne, const char *const *more,
                     const char *row, const char *form) {
  char figure[64];
  assert_true(bears_with(deck_name, -1.2 * borne, 10.85e-3, more));
  assert_false(bears_with(deck_name, -1.2 * not_borne, 10.85e-3, more));
  snprintf(figure, sizeof figure, form, borne, not_borne);
  page_says(row, figure);
}

/* Reference: 42 to 46, 65 to 70, 250 to 270. */
static void dampers_that_break(void **state) {
  (void)state;
  static const char form[] = "| %g, %g kN/m |";
  strength("one_bar", 44, 46, LIST(OFF_SITES), "| 5.4 one bar, off", form);
  strength("stirrups_bending", 68, 72, LIST(NULL), "| 5.5 stirrups, bending", form);
  strength("stirrups_shear", 270, 280, LIST(NULL), "| 5.6 stirrups, shear", form);
}

/* Those of torn bonds, too, as eq 18 is printed. */
static void dampers_that_last(void **state) {
  (void)state;
  static const char form[] = "| %g, %g |", on[] = "| 5.4 one bar, on", off[] = "| 5.4 one bar, off";
  strength("plain_beam", 42, 43, LIST(LASTING), "| 5.3 plain beam", form);
  strength("one_bar", 84, 86, LIST(LONG_STEP, LASTING), on, form);
  strength("one_bar", 54, 58, LIST(LONG_STEP, LASTING, OFF_SITES), off, form);
  strength("stirrups_bending", 72, 76, LIST(LONG_STEP, LASTING), "| 5.5 stirrups, bending", form);
  strength("stirrups_shear", 300, 320, LIST(LONG_STEP, LASTING), "| 5.6 stirrups, shear", form);
}

static void twins_by_displacement(void **state) {
  (void)state;
  carries("one_bar_path", NULL, "| 5.4 one bar, on", "| %.1f kN,", 0.5);
  carries("one_bar_path", OFF_SITES, "| 5.4 one bar, off", "| %.1f kN,", 0.5);
  carries("stirrups_bending_path", NULL, "| 5.5 stirrups, bending", "| %.1f kN,", 1); /* yields */
  carries("stirrups_shear_path", NULL, "| 5.6 stirrups, shear", "| %.1f kN,", 0.9);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(dampers_that_break),
                                     cmocka_unit_test(dampers_that_last),
                                     cmocka_unit_test(twins_by_displacement)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
