/* examples/families: what its page says of theory, and a short tie. */
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

#define PAGE  "examples/families/README.md"
#define BEAMS "examples/notched_beam/README.md"

static void says(const char *row, const char *form, double value) {
  char figure[64];
  snprintf(figure, sizeof figure, form, value);
  page_line_says(PAGE, row, figure);
}

/* --- bars and shear spans --------------------------------------------------------------------- */

static void moments_of_the_code(void **state) {
  (void)state;
  static const double bars[] = {8, 12.7, 20, 28, 40};
  for (int k = 0; k < 5; k++) {
    char row[32];
    snprintf(row, sizeof row, "| %g mm | ", bars[k]);
    says(row, "| %.2f %% |", 100 * steel_area(bars[k]) / (width * depth));
    says(row, "| %.2f kN m |", bending_moment(bars[k], 27.58e6));
    says(row, "| %.2f kN m |", bending_moment(bars[k], 192e6));
  }
  says("$M_{fl}$", "%.1f kN m", bending_moment(25.4, 27.58e6));
}

static void shear_of_the_codes(void **state) {
  (void)state;
  static const double spans[] = {1, 1.5, 2, 2.5, 3, 4, 5, 6};
  const double moment = bending_moment(25.4, 27.58e6);
  for (int k = 0; k < 8; k++) {
    char row[32];
    snprintf(row, sizeof row, "| %g | ", spans[k]);
    says(row, "| %.1f kN |", zsutty(spans[k]));
    says(row, "| %.1f kN |", model_code_90(spans[k]));
    says(row, "| %.2f |", zsutty(spans[k]) * spans[k] * depth / moment);
  }
}

/* --- size ------------------------------------------------------------------------------------- */

/* Guinea, Pastor, Planas and Elices (1998), a span of 3 depths; g = (4.5 k)^2. */
static double energy_release(double alpha) {
  const double q = 1 - alpha;
  const double p_4 = 1.9 - alpha * (-0.089 + 0.603 * q - 0.441 * q * q + 1.223 * q * q * q);
  const double p_long = 1.989 - alpha * q * (0.448 - 0.458 * q + 1.226 * q * q);
  const double p = p_long + 4.0 / 3 * (p_4 - p_long);
  const double k = sqrt(alpha) / (pow(q, 1.5) * (1 + 2 * alpha)) * p;
  return 4.5 * k * 4.5 * k;
}

/* The peak in the row of a beam, as that page has it. */
static double peak_of(const char *row) {
  char error[512];
  size_t length;
  char *page = read_text_file(SOURCE_DIR "/" BEAMS, 1 << 20, &length, error, sizeof error);
  assert_non_null(page);
  const char *at = strstr(page, row);
  for (int k = 0; at && k < 3; k++)
    at = strchr(at + 1, '|');
  assert_non_null(at);
  const double peak = 1e3 * strtod(at + 1, NULL);
  free(page);
  return peak;
}

/* 1/sigma_N^2 = A D + C, least squares. */
static void size_effect(const double depths[3], const char *row) {
  static const char *const beams[] = {"| D3, 6.35 mm", "| D6, 6.35 mm", "| D9, 6.35 mm"};
  const double alpha = 1.0 / 3, g = energy_release(alpha),
               slope = (energy_release(alpha + 1e-5) - energy_release(alpha - 1e-5)) / 2e-5;
  double x = 0, y = 0, xx = 0, xy = 0;
  for (int k = 0; k < 3; k++) {
    const double strength = peak_of(beams[k]) / (0.1524 * depths[k]),
                 inverse = 1 / (strength * strength);
    says(row, k < 2 ? " %.3f," : " %.3f MPa", 1e-6 * strength);
    x += depths[k] / 3;
    y += inverse / 3;
    xx += depths[k] * depths[k] / 3;
    xy += depths[k] * inverse / 3;
  }
  const double A = (xy - x * y) / (xx - x * x), C = y - A * x;
  says(row, "| %.1f N/m |", g / (30e9 * A));
  says(row, "| %.3f m |", C / A);
  says(row, "| %.1f mm |", 1e3 * C / A * g / slope);
}

static void size_of_notched_beams(void **state) {
  (void)state;
  size_effect((const double[]){0.07149, 0.1485, 0.2255}, "| as computed");
  size_effect((const double[]){0.0762, 0.1524, 0.2286}, "| nominal");
}

/* --- a tie ------------------------------------------------------------------------------------ */

/* Places of cracks in the last frame, m. */
static int last_cracks(workplace *w, double *places, int most) {
  size_t length;
  assert_int_equal(shell(w, "$P export tie.h5 --cracks width -o cracks.csv"), 0);
  char *table = read_bytes(w, "cracks.csv", &length);
  int count = 0, last = -1, frame;
  double time, x;
  for (const char *at = strchr(table, '\n'); at && at[1]; at = strchr(at + 1, '\n')) {
    if (sscanf(at + 1, "%d,%lf,%lf", &frame, &time, &x) != 3) break;
    if (frame != last) count = 0;
    last = frame;
    assert_true(count < most);
    places[count++] = x;
  }
  free(table);
  return count;
}

/* fib Model Code 2010: cracks are between l_s and 2 l_s apart. */
static void cracks_of_a_short_tie(void **state) {
  workplace *w = *state;
  enum { MOST = 20 };
  double places[MOST];
  const int status =
      shell(w, "$P run " SOURCE_DIR "/examples/families/tie.nml --threads 1"
               " --set 'body.corner=-0.5 m, -60.7 mm' --set 'body.size=1 m, 121.4 mm'"
               " --set 'bar.points=-0.52 m, 0, 0.52 m, 0'"
               " --set 'region[left end].at=-0.52 m, 0' --set 'region[right end].at=0.52 m, 0'"
               " --set 'monitor[width].from=-0.49 m, 0' --set 'monitor[width].to=0.49 m, 0'"
               " --set 'simulation.end_time=40 ms' > said");
  assert_int_equal(status, 0);
  const int count = last_cracks(w, places, MOST);
  const double height = 14 * 8.660254e-3, ratio = steel_area(20) / (width * height),
               transfer = height / 2 - 0.010 + 0.020 / (7.2 * ratio);
  assert_true(count >= 3);
  const double distance = (places[count - 1] - places[0]) / (count - 1);
  print_message("%d cracks, %.0f mm apart, l_s %.0f mm\n", count, 1e3 * distance, 1e3 * transfer);
  assert_true(distance > transfer && distance < 2 * transfer);
  says("| 20 mm | 179", "| %.0f, ", 1e3 * transfer);
}

int main(void) {
#define WITH(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(moments_of_the_code), cmocka_unit_test(shear_of_the_codes),
      cmocka_unit_test(size_of_notched_beams), WITH(cracks_of_a_short_tie)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
