/* The study of strength over the angle of the lattice, as its page prints it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"
#include "tests/verification/page.h"

static void check_row(const char *deck_name, const char *row, double horizon, const double *angles,
                      int count, bool half_as_fast) {
  for (int k = 0; k < count; k++) {
    char reach[64], turn[64], figure[32];
    deck_case c;
    const char *overrides[] = {reach, turn, "output.frames=0", "drive.rise=48 ms",
                               "simulation.end_time=48 ms"};
    snprintf(reach, sizeof reach, "lattice.horizon=%g", horizon);
    snprintf(turn, sizeof turn, "lattice.rotation=%g", angles[k]);
    assert_true(deck_case_run(&c, deck_name, overrides, half_as_fast ? 5 : 3));
    deck_case_go(&c);
    double most = 0;
    const double *stress = deck_case_series(&c, "stress");
    for (long n = 0; n < simulation_history(c.simulation, NULL); n++)
      most = fmax(most, stress[n]);
    deck_case_close(&c);
    snprintf(figure, sizeof figure, most < 10e6 ? "| %.2f" : "| %.1f", 1e-6 * most);
    print_message("%s %g degrees: %s\n", row, angles[k], figure);
    page_line_says("examples/horizon/README.md", row, figure);
  }
}

static void the_page_says_what_the_study_does(void **state) {
  (void)state;
  static const double five[] = {0, 7.5, 15, 22.5, 30}, three[] = {0, 15, 30};
  static const double horizons[] = {1.5, 2.1, 3.1};
  for (int h = 0; h < 3; h++) {
    char row[64];
    snprintf(row, sizeof row, "| tension, %g s |", horizons[h]);
    check_row("examples/horizon/tension.nml", row, horizons[h], five, 5, false);
    snprintf(row, sizeof row, "| compression, %g s |", horizons[h]);
    check_row("examples/horizon/compression.nml", row, horizons[h], three, 3, false);
    snprintf(row, sizeof row, "| half as fast, %g s |", horizons[h]);
    check_row("examples/horizon/compression.nml", row, horizons[h], three, 3, true);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_page_says_what_the_study_does)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
