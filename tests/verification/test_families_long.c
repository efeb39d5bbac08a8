/* The studies of examples/families as their page has them: five beams by their bar, eight by their
   shear span. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "generator/kernel/model.h"
#include "tests/generator/command_tools.h"
#include "tests/verification/family_of_beams.h"
#include "tests/verification/page.h"

#define PAGE "examples/families/README.md"

/* The peaks of a study's runs in their order, in kN. */
static int peaks_of(workplace *w, const char *name, double *peaks, int most) {
  static const char key[] = "\"load peak\": ";
  size_t length;
  int count = 0;
  assert_int_equal(
      shell(w, "$P study " SOURCE_DIR "/examples/families/%s_study.nml --json > document", name),
      0);
  char *said = read_bytes(w, "document", &length);
  for (const char *at = said; (at = strstr(at, key)) && count < most; at++)
    peaks[count++] = 1e-3 * strtod(at + strlen(key), NULL);
  free(said);
  return count;
}

static void says(const char *row, const char *form, double value) {
  char figure[64];
  snprintf(figure, sizeof figure, form, value);
  print_message("%s%s\n", row, figure);
  page_line_says(PAGE, row, figure);
}

static void beams_by_their_bar(void **state) {
  workplace *w = *state;
  static const double bars[] = {8, 12.7, 20, 28, 40};
  double peaks[5];
  assert_int_equal(peaks_of(w, "reinforcement", peaks, 5), 5);
  for (int k = 0; k < 5; k++) {
    char row[32];
    const double moment = peaks[k] / 2; /* 1 m from foot to load */
    snprintf(row, sizeof row, "| %g mm | ", bars[k]);
    says(row, "| %.2f kN m |", moment);
    if (k > 0 && k < 4) { /* the bar yields */
      assert_true(moment > bending_moment(bars[k], 27.58e6));
      assert_true(moment < 1.1 * bending_moment(bars[k], 192e6));
    }
  }
}

static void beams_by_their_shear_span(void **state) {
  workplace *w = *state;
  static const double spans[] = {1, 1.5, 2, 2.5, 3, 4, 5, 6};
  double peaks[8], parts[8];
  assert_int_equal(peaks_of(w, "kani", peaks, 8), 8);
  for (int k = 0; k < 8; k++) {
    char row[32];
    parts[k] = peaks[k] / 2 * spans[k] * depth / bending_moment(25.4, 27.58e6);
    snprintf(row, sizeof row, "| %g | ", spans[k]);
    says(row, "| %.1f kN |", peaks[k] / 2);
    says(row, "| %.2f |", parts[k]);
  }
  for (int k = 2; k < 8; k++) /* the bottom of the valley, from the arches on */
    if (k != 3) assert_true(parts[k] > parts[3]);
  assert_true(parts[7] > 1);
}

int main(void) {
#define WITH(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {WITH(beams_by_their_bar), WITH(beams_by_their_shear_span)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
