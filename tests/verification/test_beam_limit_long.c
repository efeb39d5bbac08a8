/* Peaks of the beam of cohesive bonds as its lattice gets finer, as its page has them; the finest
   spacing is left out. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "tests/verification/limit.h"

/* Mean and standard deviation, in kN. */
static void put_spread(char *text, size_t size, const double *peaks, int count) {
  double mean = 0, squares = 0;
  for (int k = 0; k < count; k++)
    mean += 1e-3 * peaks[k] / count;
  for (int k = 0; k < count; k++)
    squares += (1e-3 * peaks[k] - mean) * (1e-3 * peaks[k] - mean);
  snprintf(text, size, "%.2f ± %.2f", mean, sqrt(squares / (count - 1)));
}

/* Cases: orientations, places of sites, spacings. */
static void beam_says(const char *page, const char *row, const double *peaks, int h, int sizes) {
  enum { ORIENTATIONS = 3, PLACES = 6, RUNS = ORIENTATIONS * PLACES };
  double of[RUNS];
  char text[4][32], figure[160];
  for (int i = 0; i < RUNS; i++)
    of[i] = peaks[i * sizes + h];
  for (int o = 0; o < ORIENTATIONS; o++)
    put_spread(text[o], sizeof text[o], of + o * PLACES, PLACES);
  put_spread(text[3], sizeof text[3], of, RUNS);
  snprintf(figure, sizeof figure, "%s | %s | %s | %s", text[0], text[1], text[2], text[3]);
  says(page, row, figure);
}

/* Three sizes already have the limit of the page in their bar. */
static void peaks_of_the_cohesive_beam(void **state) {
  workplace *w = *state;
  static const char page[] = "examples/notched_beam/README.md";
  static const char *const rows[] = {"| 10 mm | ", "| 5 mm | ", "| 2.5 mm | "};
  double peaks[MOST];
  size_t length;
  assert_int_equal(shell(w, "sed -e \"s#'cohesive.nml'#'" SOURCE_DIR
                            "/examples/notched_beam/cohesive.nml'#\" -e 's/, 1.25 mm/ mm/' "
                            "" SOURCE_DIR "/examples/notched_beam/cohesive_study.nml > three.nml"),
                   0);
  assert_int_equal(shell(w, "$P study three.nml --json > document"), 0);
  char *said = read_bytes(w, "document", &length);
  assert_int_equal(numbers_of(said, "load peak", peaks), 54);
  for (int h = 0; h < 3; h++)
    beam_says(page, rows[h], peaks, h, 3);
  const double value = last_of(said, "value"), error = last_of(said, "error");
  print_message("%.6g +- %.2g N, order %.3g\n", value, error, last_of(said, "order"));
  assert_true(fabs(value - 6757) < error);
  assert_true(error < 0.1 * value);
  free(said);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test_setup_teardown(
      peaks_of_the_cohesive_beam, set_up_workplace, tear_down_workplace)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
