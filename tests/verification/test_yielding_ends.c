/* A crack in an elastic element-free zone between ends of finite elements that yield: its stress
   intensity follows the stress that the ends can carry. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"
#include "tests/verification/page.h"

#define EDGE "examples/edge_crack/"

/* sigma sqrt(pi a sec(pi a/W)), W the whole width (Feddersen 1966). */
static double intensity(double stress) {
  const double half = 0.015, width = 0.1;
  return stress * sqrt(M_PI * half / cos(M_PI * half / width));
}

/* 2.5 %: 6 cells along the crack. After yield the ends harden by 2 GPa of their strain, and the
   elastic zone holds them sideways. */
static void the_ends_limit_the_crack(void **state) {
  (void)state;
  static const char *const overrides[] = {"simulation.threads=1", "output.frames=0"};
  deck_case c;
  assert_true(deck_case_run(&c, EDGE "yielding_ends.nml", overrides, 2));
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double *load = deck_case_series(&c, "load"), *K = deck_case_series(&c, "K_I"),
               *opening = deck_case_series(&c, "opening");
  assert_int_equal(simulation_history(c.simulation, NULL), 21);
  for (int n = 1; n <= 20; n++) {
    const double stress = load[n] / (0.1 * 0.01);
    assert_true(fabs(K[n] / intensity(stress) - 1) < 0.025);
    if (n % 5 == 0 || n == 11) {
      char line[32], figure[96];
      snprintf(line, sizeof line, "| %.3f mm |", 1e3 * opening[n]);
      snprintf(figure, sizeof figure, "| %.1f | %.2f | %.2f |", 1e-6 * stress, 1e-6 * K[n],
               1e-6 * intensity(stress));
      page_line_says(EDGE "README.md", line, figure);
    }
  }
  const double slope = K[9] / opening[9], later = (K[20] - K[12]) / (opening[20] - opening[12]);
  assert_true(fabs(load[9] / load[1] / 9 - 1) < 1e-3);
  assert_true(later < 0.05 * slope);
  assert_true(load[12] > 248e3 && load[20] < 265e3);
  assert_true(deck_case_last(&c, "plate.above/dissipated_damage") > 20);
  deck_case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_ends_limit_the_crack),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
