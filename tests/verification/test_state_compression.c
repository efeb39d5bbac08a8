/* The state-based lattice in compression, up to just past the peak (Nikravesh 2017, section 5.2.3):
   yield, flow and crushing, and the profile 'objective', whose strength must not depend on how the
   lattice is turned. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/specimen.h"

static const double theory = 620.55e3; /* N: strength times section */

static void check(const char *deck_name, double reference, bool symmetric) {
  const outcome o = specimen_run(deck_name, "8.4 ms", NULL);
  print_message("%s: peak %.1f N at %.3f ms (reference %.0f: %+.2f %%; theory %+.1f %%), ends "
                "differ by %.1e, asymmetry "
                "%.1e\n",
                deck_name, o.peak, 1e3 * o.time, reference, 100 * (o.peak / reference - 1),
                100 * (o.peak / theory - 1), o.ends, o.asymmetry);
  assert_true(fabs(o.peak / reference - 1) < 0.01);
  assert_true(o.peak > 0.86 * theory && o.peak < 1.02 * theory);
  assert_true(o.damage > 0.5);
  assert_true(o.ends < 0.02);
  if (symmetric) assert_true(o.asymmetry < 1e-8);
}

static void the_prism_reaches_its_strength(void **state) {
  (void)state;
  check("examples/compression/rot0.nml", 581500, true);
}

/* Turned by 15 degrees the published profile carries 30 % less. */
static void the_objective_profile_does_so_when_turned(void **state) {
  (void)state;
  check("examples/compression/rot15_objective.nml", 565100, false);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_prism_reaches_its_strength),
      cmocka_unit_test(the_objective_profile_does_so_when_turned),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
