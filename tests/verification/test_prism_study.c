/* The strength of a prism over the spacing, of three orientations: a study that converges, and one
   that does not. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "tests/verification/study_said.h"

/* Theory says f_t. The load has no limit yet at these sizes: its width hangs on the rows that
   fit. */
static void the_strength_of_a_prism_converges(void **state) {
  workplace *w = *state;
  static const char prism[] = EXAMPLES
      "tension/strength.nml --set relaxation.increments=96 --vary lattice.rotation=0,15,30 --vary "
      "'lattice.spacing=20,10,5 mm' --converge spacing --x displacement --y";
  char arguments[1000];
  snprintf(arguments, sizeof arguments, "%s stress", prism);
  study(w, 0, arguments);
  is_near(number("order"), 1, 0.4);
  is_near(number("value"), 2.6168e6, number("error"));
  is_near(number("value"), 2.6168e6, 0.03 * 2.6168e6);
  assert_true(number("error") < 0.1 * 2.6168e6);
  snprintf(arguments, sizeof arguments, "%s load", prism);
  study(w, 2, arguments);
  assert_true(isnan(number("order")) || number("order") < 0.5);
  assert_true(isnan(number("value")) && isnan(number("error")));
  assert_non_null(strstr(said, "\"converged\": false"));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test_setup_teardown(
      the_strength_of_a_prism_converges, set_up_workplace, tear_down_workplace)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
