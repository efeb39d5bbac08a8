/* Slender beams bent at rest against the theory of beams. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"

static const double E = 30e9, nu = 0.2;

static const double height = 0.1, reach = 0.8, thickness = 0.01, force = 10; /* m, N */

/* How far a force bends the end of a cantilever of so many rows; its left end is held. */
static double bent_by_force(int layers, const char *setting) {
  const double s = height / (layers * sqrt(3) / 2), top = height - 0.4 * s;
  deck_case c;
  char text[1400];
  snprintf(text, sizeof text,
           "&simulation end_time = 1 threads = 1 /\n&relaxation increments = 1 tolerance = 1e-6 /\n"
           "&lattice name = 'l' kind = 'hexagonal' spacing = %.17g thickness = %.17g "
           "setting = '%s' /\n"
           "&material lattice = 'l' model = 'elastic_micropolar' E = %.17g nu = %.17g /\n"
           "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = %.17g, %.17g /\n"
           "&region name = 'held' shape = 'rectangle' corner = 0, 0 size = %.17g, 1 /\n"
           "&region name = 'end' shape = 'rectangle' corner = %.17g, 0 size = 1, 1 /\n"
           "&support region = 'held' fix = 'xy' /\n"
           "&force region = 'end' component = 'y' total = %.17g /\n"
           "&monitor name = 'bent' kind = 'displacement' region = 'end' component = 'y' /\n",
           s, thickness, setting, E, nu, reach, top, 0.51 * s, reach - 1.01 * s, force);
  assert_true(deck_case_text(&c, text));
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double bent = deck_case_series(&c, "bent")[simulation_history(c.simulation, NULL) - 1];
  deck_case_close(&c);
  return bent;
}

/* Bending goes with the modulus that the plane sees, E or E/(1 - nu^2); shear, which adds to it
   3 E I/(k G A L^2) = h^2 (1 + nu)/(2 k L^2) with k = 5/6, goes with G, which both settings have
   alike. The outer rows lack bonds, which counts as much as one row among all. */
static void plane_strain_bends_less(void **state) {
  (void)state;
  const double shear = height * height * (1 + nu) / (2 * 5.0 / 6 * reach * reach);
  const double factor = (1 + shear) / (1 - nu * nu + shear);
  double before = INFINITY, limit = INFINITY;
  for (int layers = 6; layers <= 24; layers *= 2) {
    const double stress = bent_by_force(layers, "plane_stress");
    const double error = stress / bent_by_force(layers, "plane_strain") / factor - 1;
    const double theory = 4 * force * reach * reach * reach /
                          (E * thickness * height * height * height) * (1 + shear);
    print_message("%2d rows: %+.2f %% of theory in plane stress, against plane strain %+.2f %%\n",
                  layers, 100 * (stress / theory - 1), 100 * error);
    assert_true(fabs(error) < 0.7 * fabs(before));
    limit = 2 * error - before;
    before = error;
  }
  assert_true(fabs(limit) < 2e-3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(plane_strain_bends_less),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
