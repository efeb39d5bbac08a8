/* The laboratory's beam with a notch off the middle and its L-shaped panel, with the parameters stated with
   the tests: how far the curves are from the measured ones is what the page says, and the runs are
   quasi-static. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "generator/results/curve_gap.h"
#include "generator/results/measured.h"
#include "tests/verification/case.h"
#include "tests/verification/page.h"

#define FOLDER "examples/laboratory/"

typedef struct laboratory {
  const char *name, *x, *band;
  const char *feet[2]; /* reactions that bear the load */
  const char *row;     /* of the page, with peak, largest distance and root of the mean square */
} laboratory;

static const laboratory beam = {"mixed_mode_beam",
                                "cmod",
                                "load_low,load_high",
                                {"left_foot", "right_foot"},
                                "| [mixed_mode_beam.nml]"},
                        panel = {"l_panel", "displacement", NULL, {"foot_load"}, "| [l_panel.nml]"};

static void says(const laboratory *l, const char *form, double value) {
  char figure[64];
  snprintf(figure, sizeof figure, form, value);
  page_line_says(FOLDER "README.md", l->row, figure);
}

/* Inertia has no part: little kinetic energy up to the peak, the feet carry the load, and the ledger
   closes. */
static void is_quasi_static(const laboratory *l, const deck_case *c, long peak) {
  const double *kinetic = deck_case_series(c, "energy/kinetic"),
               *work = deck_case_series(c, "energy/external"), *load = deck_case_series(c, "load");
  double feet = 0;
  for (int k = 0; k < 2 && l->feet[k]; k++)
    feet += deck_case_series(c, l->feet[k])[peak];
  const double imbalance =
      deck_case_last(c, "energy/imbalance") / deck_case_last(c, "energy/external");
  print_message("  at the peak: kinetic energy %.2e of the work, feet %+.2e; imbalance %.1e\n",
                kinetic[peak] / work[peak], feet / load[peak] - 1, imbalance);
  assert_true(kinetic[peak] < 0.01 * work[peak]);
  assert_true(fabs(feet / load[peak] - 1) < 0.02);
  assert_true(fabs(imbalance) < 0.005);
}

static void compare_with_table(const laboratory *l, const deck_case *c, long samples) {
  const measured_axes axes = {l->x, (const char *const[]){"load"}, 1, "m", "N"};
  char path[512];
  diagnostics said;
  source_set sources = {NULL, 0};
  measured m;
  curve_gap g;
  double largest = 0;
  snprintf(path, sizeof path, SOURCE_DIR "/" FOLDER "%s.csv", l->name);
  diag_begin(&said, &sources);
  assert_true(measured_read(&m, "table", path, l->band, &axes, &said));
  const curve_points points = {m.x, l->band ? m.low : m.y, l->band ? m.high : m.y, m.count};
  for (long k = 0; k < m.count; k++)
    largest = fmax(largest, points.high[k]);
  assert_true(
      curve_gap_find(deck_case_series(c, l->x), deck_case_series(c, "load"), samples, &points, &g));
  print_message("  largest gap %.3f of the largest measured load, rms %.4f\n", g.largest / largest,
                g.rms / largest);
  says(l, "%.0f %%", 100 * g.largest / largest);
  says(l, "%.1f %%", 100 * g.rms / largest);
  measured_free(&m);
  diag_clear(&said);
  source_clear(&sources);
}

static void check(const laboratory *l, const char *const *overrides, int count) {
  deck_case c;
  char deck_path[256];
  snprintf(deck_path, sizeof deck_path, FOLDER "%s.nml", l->name);
  assert_true(deck_case_run(&c, deck_path, overrides, count));
  assert_int_equal(deck_case_go(&c), STEP_STOPPED);
  const long samples = simulation_history(c.simulation, NULL);
  const double *load = deck_case_series(&c, "load");
  const long peak = largest_of(load, samples);
  print_message("%s: %.1f N at %.4g mm\n", l->name, load[peak],
                1e3 * deck_case_series(&c, l->x)[peak]);
  says(l, "%.2f kN", 1e-3 * load[peak]);
  is_quasi_static(l, &c, peak);
  compare_with_table(l, &c, samples);
  deck_case_close(&c);
}

static void beam_with_a_notch_off_the_middle(void **unused) {
  (void)unused;
  check(&beam, NULL, 0);
}

static void l_shaped_panel(void **unused) {
  (void)unused;
  check(&panel, NULL, 0);
}

/* What the fit of the beam changed, carried over. */
static void the_panel_is_predicted(void **unused) {
  (void)unused;
  static const char *const carried[] = {"material.S_t=1.27074e-4", "material.alpha2=9.943",
                                        "material.alpha3=331.25"};
  laboratory predicted = panel;
  predicted.row = "| predicted";
  check(&predicted, carried, 3);
}

static void the_beam_is_fitted(void **unused) {
  (void)unused;
  static const char *const fitted_values[] = {"material.S_t=1.25979e-4", "material.alpha2=40.7424",
                                              "material.alpha3=1357.16"};
  laboratory fitted = beam;
  fitted.row = "| fitted curve";
  check(&fitted, fitted_values, 3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(beam_with_a_notch_off_the_middle),
      cmocka_unit_test(l_shaped_panel),
      cmocka_unit_test(the_beam_is_fitted),
      cmocka_unit_test(the_panel_is_predicted),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
