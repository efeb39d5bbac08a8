/* The static examples: what their decks give beside theory and another program, and that their
   pages say it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"
#include "tests/verification/page.h"

static double solved(const char *file, const char *const *changes, int count, const char *series) {
  deck_case c;
  assert_true(deck_case_run(&c, file, changes, count));
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double value = deck_case_last(&c, series), stored = deck_case_last(&c, "energy/stored");
  assert_true(fabs(deck_case_last(&c, "energy/external") - stored) < 1e-9 * stored);
  deck_case_close(&c);
  return value;
}

static void page_has(const char *page, const char *beginning, const char *format, double value) {
  char figure[64];
  snprintf(figure, sizeof figure, format, value);
  page_line_says(page, beginning, figure);
}

/* --- the edge crack --------------------------------------------------------------------------- */

#define EDGE "examples/edge_crack/"

/* sigma sqrt(pi a) F (Tada, Paris and Irwin). */
static double edge_theory(void) {
  const double a = 0.475, r = M_PI * a / 2;
  return sqrt(M_PI * a) * sqrt(tan(r) / r) * (0.752 + 2.02 * a + 0.37 * pow(1 - sin(r), 3)) /
         cos(r);
}

static const char *const boxes[] = {"1", "1.5", "2", "3", "4", "6"};

/* Two boxes of each row; the others are those of runtime/continuum/test_static_cracks.c. */
static void edge_row(const char *support, const char *weight, const double known[6]) {
  char row[64], changes[3][64];
  snprintf(row, sizeof row, "| support %s, %s", support, weight);
  for (int k = 2; k < 6; k += 3) {
    snprintf(changes[0], 64, "mesh.support=%s", support);
    snprintf(changes[1], 64, "tips.integral=%s", weight);
    snprintf(changes[2], 64, "tips.half_size=%s", boxes[k]);
    const char *const list[] = {changes[0], changes[1], changes[2]};
    const double K = solved(EDGE "edge.nml", list, 3, "crack/K_I");
    assert_true(fabs(K - known[k]) < 1e-3 * known[k]);
    page_has(EDGE "README.md", row, " %.4f |", K);
  }
}

static void the_edge_crack_by_box_weight_and_support(void **state) {
  (void)state;
  edge_row("2.1", "pyramid", (double[]){2.8179, 2.9489, 3.0308, 3.1250, 3.1619, 3.2012});
  edge_row("2.1", "plateau", (double[]){3.1037, 3.3239, 3.1885, 3.2685, 3.2833, 3.2732});
  edge_row("3.5", "pyramid", (double[]){2.3377, 2.5668, 2.7577, 3.0173, 3.1211, 3.2579});
  edge_row("3.5", "plateau", (double[]){3.0688, 3.3883, 3.3584, 3.6069, 3.5652, 3.5297});
}

static void the_edge_cracks_energy_and_limit(void **state) {
  (void)state;
  const char *const wide[] = {"mesh.support=3.5"};
  const double energy = solved(EDGE "edge.nml", NULL, 0, "energy/stored"),
               energy_wide = solved(EDGE "edge.nml", wide, 1, "energy/stored");
  assert_true(fabs(energy - 2.80654) < 1e-5 && fabs(energy_wide - 2.98933) < 1e-5);
  page_has(EDGE "README.md", "| support 2.1 |", "| %.5f |", energy);
  page_has(EDGE "README.md", "| support 3.5 |", "| %.5f |", energy_wide);
  const char *const fine[] = {"mesh.nodes=81, 242", "tips.half_size=4", "tips.integral=pyramid"};
  const double K = solved(EDGE "edge.nml", fine, 3, "crack/K_I");
  assert_true(fabs(K - edge_theory()) < 0.03 * edge_theory());
  page_has(EDGE "README.md", "| pyramid |", "| %.3f |", K);
}

/* On elements alone: the error falls with the spacing. */
static void half_of_the_plate_in_elements(void **state) {
  (void)state;
  static const char *const nodes[][2] = {{"mesh.nodes=41, 61", "| 41 x 61"},
                                         {"mesh.nodes=81, 121", "| 81 x 121"},
                                         {"mesh.nodes=161, 241", "| 161 x 241"}};
  double before = 1;
  for (int k = 0; k < 3; k++) {
    const char *const changes[] = {nodes[k][0], "tips.half_size=4"};
    const double K = solved(EDGE "half.nml", changes, 2, "crack/K_I"),
                 error = K / edge_theory() - 1;
    print_message("half of the plate: %.4f, %+.2f %%\n", K, 100 * error);
    page_has(EDGE "README.md", nodes[k][1], "| %.3f |", K);
    page_has(EDGE "README.md", nodes[k][1], "| %.1f %% |", 100 * error);
    assert_true(fabs(error) < 0.03 && fabs(error) < 0.7 * before);
    before = fabs(error);
  }
}

/* --- shear ------------------------------------------------------------------------------------ */

#define SHEAR "examples/shear_crack/"

static void the_sheared_plate(void **state) {
  (void)state;
  const double first = solved(SHEAR "shear.nml", NULL, 0, "crack/K_I"),
               second = solved(SHEAR "shear.nml", NULL, 0, "crack/K_II"),
               energy = solved(SHEAR "shear.nml", NULL, 0, "energy/stored");
  assert_true(fabs(first - 34.0) < 0.03 * 34.0 && fabs(second - 4.55) < 0.03 * 4.55);
  assert_true(fabs(first - 34.10) < 1e-3 * 34.10 && fabs(second - 4.482) < 1e-3 * 4.482);
  assert_true(fabs(energy - 8.6227e-5) < 1e-3 * energy);
  assert_true(fabs(solved(SHEAR "shear.nml", NULL, 0, "shear") - 7) < 1e-8);
  page_has(SHEAR "README.md", "| K_I |", "| %.2f |", first);
  page_has(SHEAR "README.md", "| K_II |", "| %.3f |", second);
  page_has(SHEAR "README.md", "| stored energy |", "%.4fe-5 |", 1e5 * energy);
}

/* --- Cook's membrane -------------------------------------------------------------------------- */

#define COOK "examples/cook/"

static void cooks_membrane(void **state) {
  (void)state;
  for (int gauss = 1; gauss <= 2; gauss++) {
    double before = 1e9;
    for (int cells = 2; cells <= 128; cells *= 2) {
      char nodes[64], rule[64], row[64];
      snprintf(nodes, sizeof nodes, "mesh.nodes=%d, %d", cells + 1, cells + 1);
      snprintf(rule, sizeof rule, "mesh.gauss=%d", gauss);
      snprintf(row, sizeof row, "| %d x %d |", cells, cells);
      const char *const changes[] = {nodes, rule};
      const double way = solved(COOK "cook.nml", changes, 2, "tip");
      page_has(COOK "README.md", row, gauss == 1 ? "| %.2f |" : " %.2f |", way);
      assert_true(fabs(way - 23.96) < before);
      assert_true(gauss == 1 ? way > 23.96 : way < 23.96);
      before = fabs(way - 23.96);
    }
    assert_true(before < 0.01);
  }
  assert_true(fabs(solved(COOK "cook.nml", NULL, 0, "load") - 1) < 1e-10);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_edge_crack_by_box_weight_and_support),
                                     cmocka_unit_test(the_edge_cracks_energy_and_limit),
                                     cmocka_unit_test(half_of_the_plate_in_elements),
                                     cmocka_unit_test(the_sheared_plate),
                                     cmocka_unit_test(cooks_membrane)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
