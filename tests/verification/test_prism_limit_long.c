/* The strength of the prism in tension as its lattice gets finer: f_t, and as its page has it. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "tests/verification/limit.h"

static void strength_of_the_prism(void **state) {
  workplace *w = *state;
  static const char page[] = "examples/tension/README.md";
  static const char *const rows[] = {"| 20 mm | ", "| 10 mm | ", "| 5 mm | ", "| 2.5 mm | "};
  double peaks[MOST];
  char figure[128];
  size_t length;
  assert_int_equal(
      shell(w, "$P study " SOURCE_DIR "/examples/tension/converge_study.nml --json > document"), 0);
  char *said = read_bytes(w, "document", &length);
  assert_int_equal(numbers_of(said, "stress peak", peaks), 12);
  for (int h = 0; h < 4; h++) {
    const double a = 1e-6 * peaks[h], b = 1e-6 * peaks[4 + h], c = 1e-6 * peaks[8 + h];
    snprintf(figure, sizeof figure, "%.3f | %.3f | %.3f | %.3f MPa", a, b, c, (a + b + c) / 3);
    says(page, rows[h], figure);
  }
  const double value = last_of(said, "value"), error = last_of(said, "error");
  snprintf(figure, sizeof figure, "%.6g Pa, +- %.2g (%.2g %%), with order %.3g", value, error,
           100 * error / value, last_of(said, "order"));
  says(page, "      peak of stress goes to ", figure);
  assert_true(fabs(value - 2.6168e6) < error);
  assert_true(fabs(value - 2.6168e6) < 0.01 * 2.6168e6);
  free(said);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test_setup_teardown(
      strength_of_the_prism, set_up_workplace, tear_down_workplace)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
