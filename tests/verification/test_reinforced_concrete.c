/* The prisms and the beam without bars of examples/reinforced_concrete (Gerstle et al. 2013,
   sections 5.1 to 5.3): largest load that each bears, what its twin by displacement carries, what
   the pages say. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"

#define FOLDER "examples/reinforced_concrete/"
static const double section = 0.10 * 0.127; /* m^2: of a prism */

/* A line of the page's table holds both texts. */
static void page_says(const char *beginning, const char *figure) {
  char error[512], line[512];
  size_t length;
  char *page =
      read_text_file(SOURCE_DIR "/" FOLDER "README.md", 1 << 20, &length, error, sizeof error);
  assert_non_null(page);
  const char *row = strstr(page, beginning);
  assert_non_null(row);
  snprintf(line, sizeof line, "%.*s", (int)strcspn(row, "\n"), row);
  if (!strstr(line, figure)) fail_msg("%s\nshould say %s", line, figure);
  free(page);
}

/* A deck until its end, with two more overrides, or NULL. */
static void run(deck_case *c, const char *deck_name, const char *more, const char *again) {
  char path[256];
  const char *overrides[3] = {"simulation.threads=1", more, again};
  snprintf(path, sizeof path, FOLDER "%s.nml", deck_name);
  assert_true(deck_case_run(c, path, overrides, 1 + (more != NULL) + (again != NULL)));
  const step_status status = deck_case_go(c);
  assert_true(status == STEP_END || status == STEP_STOPPED);
  const long samples = simulation_history(c->simulation, NULL);
  const double imbalance = deck_case_series(c, "energy/imbalance")[samples - 1],
               external = deck_case_series(c, "energy/external")[samples - 1];
  if (!(fabs(imbalance) < 1e-2 * external)) fail_msg("%s: imbalance %g J", deck_name, imbalance);
}

static double largest_in(const double *values, const double *time, long samples, double from,
                         double until) {
  double most = 0;
  for (long k = 0; k < samples; k++)
    if (time[k] >= from && time[k] <= until) most = fmax(most, fabs(values[k]));
  return most;
}

/* Under the force `kN` held from `held`, s, on: the deflection of the second half of the hold is
   that of the first, within 5 %. */
static bool bears(const char *deck_name, double kN, double held) {
  deck_case c;
  char total[64];
  snprintf(total, sizeof total, "force.total=%.9g kN", kN);
  run(&c, deck_name, total, NULL);
  const double *time, *deflection = deck_case_series(&c, "deflection"),
                      *load = deck_case_series(&c, "load");
  const long samples = simulation_history(c.simulation, &time);
  const double end = time[samples - 1], middle = (held + end) / 2;
  const double first = largest_in(deflection, time, samples, held, middle),
               second = largest_in(deflection, time, samples, middle, end);
  assert_true(fabs(fabs(load[samples - 1]) - 1e3 * fabs(kN)) < 1e-6);
  print_message("%s, %g kN: deflection %.4g, then %.4g m\n", deck_name, kN, first, second);
  deck_case_close(&c);
  return second <= 1.05 * first;
}

/* The prism bears one stress, MPa, and does not bear the other; the page says so. */
static void strength(const char *deck_name, const char *row, double borne, double not_borne) {
  char figure[64];
  assert_true(bears(deck_name, 1e3 * borne * section, 1.36e-3));
  assert_false(bears(deck_name, 1e3 * not_borne * section, 1.36e-3));
  snprintf(figure, sizeof figure, "| %.6g, %.6g MPa |", fabs(borne), fabs(not_borne));
  page_says(row, figure);
}

/* The source: 2.784 and 3.226; an independent computation with these ends: 2.79 and 3.13. */
static void prisms_in_tension(void **state) {
  (void)state;
  strength("tension_across", "| 5.1 tension, across", 2.78, 2.79);
  strength("tension_along", "| 5.1 tension, along", 3.12, 3.13);
}

/* Of the direction of the rows: 9.5 MPa across them, and many times as much along them. */
static void prisms_in_compression(void **state) {
  (void)state;
  strength("compression_across", "| 5.2 compression, across", -9.5, -9.75);
  assert_true(bears("compression_along", -80e3 * section, 1.36e-3));
}

/* 42 kN/m; an independent computation: 42 to 44. */
static void plain_beam(void **state) {
  (void)state;
  assert_true(bears("plain_beam", -42 * 1.2, 10.85e-3));
  assert_false(bears("plain_beam", -43 * 1.2, 10.85e-3));
  page_says("| 5.3 plain beam", "| 42, 43 kN/m |");
}

/* --- by displacement -------------------------------------------------------------------------- */

static void carries(const char *deck_name, const char *more, const char *row, const char *form) {
  deck_case c;
  char figure[64];
  run(&c, deck_name, more, NULL);
  const double *load = deck_case_series(&c, "load");
  const long samples = simulation_history(c.simulation, NULL);
  double most = 0;
  for (long k = 0; k < samples; k++)
    most = fmax(most, fabs(load[k]));
  print_message("%s: peak %.6g N, %.6g N left\n", deck_name, most, fabs(load[samples - 1]));
  snprintf(figure, sizeof figure, form, most / 1e3);
  page_says(row, figure);
  assert_true(fabs(load[samples - 1]) < 0.05 * most); /* it is in two */
  deck_case_close(&c);
}

static void twins_by_displacement(void **state) {
  (void)state;
  carries("tension_across_path", NULL, "| 5.1 tension, across", "| %.2f kN,");
  carries("tension_along_path", NULL, "| 5.1 tension, along", "| %.2f kN,");
  carries("compression_across_path", NULL, "| 5.2 compression, across", "| %.1f kN,");
  carries("compression_along_path", NULL, "| 5.2 compression, along", "| %.0f kN,");
  carries("plain_beam_path", "simulation.step=1.808 us", "| 5.3 plain beam", "| %.2f kN,");
}

/* The halves of a broken beam move apart: open bonds do not rub, and the ledger knows. */
static void open_bonds_do_not_rub(void **state) {
  (void)state;
  deck_case c;
  run(&c, "plain_beam", "force.total=-55.2 kN", "material.friction=stick_slip");
  const double *lost = deck_case_series(&c, "energy/dissipated_damage");
  const long samples = simulation_history(c.simulation, NULL);
  print_message("broken beam with friction: %.4g J lost, imbalance %.2g J\n", lost[samples - 1],
                deck_case_series(&c, "energy/imbalance")[samples - 1]);
  assert_true(lost[samples - 1] > 1);
  deck_case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(prisms_in_tension),
      cmocka_unit_test(prisms_in_compression),
      cmocka_unit_test(plain_beam),
      cmocka_unit_test(twins_by_displacement),
      cmocka_unit_test(open_bonds_do_not_rub),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
