/* What must become better as the discretisation becomes finer: the energy balance of an elastic
   beam with the time step, the deflection of an elastic cantilever with the spacing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/cantilever.h"

/* --- time step -------------------------------------------------------------------------------- */

/* Largest imbalance over the external work at the end, of a driven elastic beam. */
static double imbalance(double safety, double zeta) {
  char text[2000];
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-3 step_safety = %g /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = 6.35e-3 thickness = 0.1524 /\n"
           "&material lattice = 'c' model = 'mplm_bilinear' S_t = 0.5 zeta = %g /\n"
           "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.2286, 0.067 /\n"
           "&region name = 'left' shape = 'point' at = 0, 0 /\n"
           "&region name = 'right' shape = 'point' at = 0.2286, 0 /\n"
           "&region name = 'top' shape = 'point' at = 0.1143, 0.065991136 /\n"
           "&support region = 'left' fix = 'xy' /\n&support region = 'right' fix = 'y' /\n"
           "&drive region = 'top' component = 'y' velocity = -0.02 rise = 0.5e-3 /\n"
           "&output frames = 0 sample = 1e-5 /\n",
           safety, zeta);
  deck_case c;
  assert_true(deck_case_text(&c, text));
  assert_int_equal(deck_case_go(&c), STEP_END);
  const long samples = simulation_history(c.simulation, NULL);
  const double *left_over = deck_case_series(&c, "energy/imbalance");
  const double external = deck_case_series(&c, "energy/external")[samples - 1];
  assert_true(external > 0 && deck_case_series(&c, "energy/dissipated_damage")[samples - 1] == 0);
  double largest = 0;
  for (long k = 0; k < samples; k++)
    largest = fmax(largest, fabs(left_over[k]));
  deck_case_close(&c);
  return largest / external;
}

/* Without the damper the bonds are linear, for which the ledger is exact at any step: only geometry
   is left, of second order. The damper knows the velocity of half a step before, which leaves first
   order. The drive is slow enough for stretches of 1e-5: where friction is stiff (0.05 |stretch|
   over 10 1/s times the step is more than about one) the sign of the rate alternates from step to
   step, and no rule integrates that. */
static void energy_balances_better_with_smaller_steps(void **state) {
  (void)state;
  static const double safeties[] = {0.8, 0.4, 0.2, 0.1};
  double plain[4], damped[4];
  for (int k = 0; k < 4; k++) {
    plain[k] = imbalance(safeties[k], 0);
    damped[k] = imbalance(safeties[k], 0.05);
    print_message(
        "%.1f of the stable step: imbalance %.2e undamped, %.2e damped, of the external work\n",
        safeties[k], plain[k], damped[k]);
  }
  for (int k = 1; k < 4; k++) {
    print_message("order %.2f undamped, %.2f damped\n", log2(plain[k - 1] / plain[k]),
                  log2(damped[k - 1] / damped[k]));
    assert_true(fabs(log2(plain[k - 1] / plain[k]) - 2) < 0.1);
    assert_true(fabs(log2(damped[k - 1] / damped[k]) - 1) < 0.1);
  }
}

/* --- spacing ---------------------------------------------------------------------------------- */

static const double depth = 0.1, thickness = 0.1;                 /* m */
static const double modulus = 30e9, ratio = 0.2, end_load = 1000; /* Pa, 1, N */

/* Displacement of a cantilever, clamped at x = 0, under a parabolic shear at x = length, in plane
   stress, with depth from -depth/2 to depth/2 (Timoshenko & Goodier 1951, article 20; in
   this form Augarde & Deeks 2008). */
static void exact(double length, double x, double y, double *ux, double *uy) {
  const double EI = modulus * thickness * depth * depth * depth / 12, nu = ratio;
  *ux =
      end_load * y / (6 * EI) * ((6 * length - 3 * x) * x + (2 + nu) * (y * y - depth * depth / 4));
  *uy = -end_load / (6 * EI) *
        (3 * nu * y * y * (length - x) + (4 + 5 * nu) * depth * depth * x / 4 +
         (3 * length - x) * x * x);
}

/* Of `row_count` rows; each row stands for its share of the depth, as its particles' volume does.
   The loaded columns are half a spacing apart. */
static double tip_error(law_case *beam_law, int row_count) {
  cantilever b = {.s = depth / row_count * 2 / sqrt(3)};
  char text[1000];
  const double half = (row_count - 1) * sqrt(3) / 4 * b.s;
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = %.17g thickness = %.17g origin = 0, "
           "%.17g /\n"
           "&material lattice = 'c' model = 'mplm_bilinear' /\n"
           "&body lattice = 'c' shape = 'rectangle' corner = 0, %.17g size = %.17g, %.17g /\n",
           b.s, thickness, -half, -half, round(0.4 / b.s) * b.s, 2 * half);
  assert_true(deck_case_lattice(&b.c, text));
  rows_set_density(b.c.lattice, 2323);
  assert_int_equal(b.c.lattice->row_count, row_count);
  cantilever_open(&b, beam_law->compiled, beam_law->parameters);
  b.length = b.g->width - b.s / 4;
  cantilever_ends(&b, 0.75 * b.s, b.g->width - 0.75 * b.s, end_load, depth);
  const double error = cantilever_error(&b, exact);
  cantilever_close(&b);
  return error;
}

/* The outermost rows lack the bonds to a further row, so that the beam is too soft by O(s/depth):
   first order. What first order leaves, after extrapolation, is of second order in s/depth = 0.036:
   1e-3. */
static void a_cantilever_converges_to_theory(void **state) {
  (void)state;
  static const int row_counts[] = {8, 16, 32};
  law_case c;
  double error[3];
  assert_true(law_case_open(&c, "mplm_bilinear"));
  *law_case_value(&c, "nu") = ratio;
  *law_case_value(&c, "S_t") = 0.5;
  for (int k = 0; k < 3; k++)
    error[k] = tip_error(&c, row_counts[k]);
  law_case_close(&c);
  const double extrapolated = 2 * error[2] - error[1];
  print_message("cantilever: orders %.2f, %.2f; extrapolated error %.1e\n",
                log2(error[0] / error[1]), log2(error[1] / error[2]), extrapolated);
  assert_true(fabs(log2(error[0] / error[1]) - 1) < 0.1);
  assert_true(fabs(log2(error[1] / error[2]) - 1) < 0.1);
  assert_true(error[2] > 0 && error[2] < 0.02);
  assert_true(fabs(extrapolated) < 1e-3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(energy_balances_better_with_smaller_steps),
      cmocka_unit_test(a_cantilever_converges_to_theory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
