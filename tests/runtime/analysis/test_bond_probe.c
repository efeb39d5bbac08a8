/* One bond through pl_law's `states` and `tangent`: forces of a linear bar against EA times
   stretch, damage that is shown, taken over and forgotten, the tangent against differences of the
   forces. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdlib.h>

#include "runtime/analysis/bond_probe.h"
#include "tests/runtime/elastic_law.h"

#define E_MODULUS 30e9
#define NU        0.2
#define S_T       1e-4

static const pl_bond_class a_bond = {.size = sizeof(pl_bond_class),
                                     .s = 0.01,
                                     .spacing = 0.01,
                                     .t = 0.1,
                                     .shell = 1,
                                     .n = 6,
                                     .chord = {0.01, 0, 0}};
static const double values[ELASTIC_PARAMETERS] = {E_MODULUS, NU, 2323, 0, S_T};

static double EA(void) {
  return E_MODULUS * a_bond.s * a_bond.t / (sqrt(3) * (1 - NU));
}

static void near(double found, double expected, double tolerance) {
  if (!(fabs(found - expected) <= tolerance * fabs(expected)))
    fail_msg("%.17g is not %.17g", found, expected);
}

static void forces_are_those_of_the_law(void **state) {
  (void)state;
  bond_probe *p = bond_probe_new(&elastic_beam, values, &a_bond);
  double f[PL_STATE_RESULTS];
  const double EI =
      E_MODULUS * pow(a_bond.s, 3) * a_bond.t * (1 - 3 * NU) / (12 * sqrt(3) * (1 - NU * NU));
  bond_probe_forces(p, (bond_motion){0.5 * S_T, 0, 2e-3, -1e-3}, f);
  near(f[0], 0.5 * S_T * EA(), 1e-14);
  near(f[1], 2 * EI / a_bond.s * (2 * 2e-3 - 1e-3), 1e-12);
  assert_true(fabs(f[2]) < 1e-12 * fabs(f[1]));
  bond_probe_free(p);
}

/* omega = (stretch - S_t)/S_t; the force is (1 - omega) EA stretch. */
static void fields_go_on_only_when_accepted(void **state) {
  (void)state;
  bond_probe *p = bond_probe_new(&elastic_beam, values, &a_bond);
  double f[PL_STATE_RESULTS];
  bond_probe_forces(p, (bond_motion){.stretch = 1.25 * S_T}, f);
  near(p->new_fields[0], 0.25, 1e-12);
  near(f[0], 0.75 * 1.25 * S_T * EA(), 1e-12);
  assert_true(p->fields[0] == 0);

  bond_probe_forces(p, (bond_motion){.stretch = 0.5 * S_T}, f);
  near(f[0], 0.5 * S_T * EA(), 1e-12); /* as if it had never been further */
  bond_probe_forces(p, (bond_motion){.stretch = 1.25 * S_T}, f);
  bond_probe_accept(p);
  bond_probe_forces(p, (bond_motion){.stretch = 0.5 * S_T}, f);
  near(f[0], 0.75 * 0.5 * S_T * EA(), 1e-12);
  bond_probe_reset(p);
  bond_probe_forces(p, (bond_motion){.stretch = 0.5 * S_T}, f);
  near(f[0], 0.5 * S_T * EA(), 1e-12);
  bond_probe_free(p);
}

static void the_tangent_is_the_slope_of_the_forces(void **state) {
  (void)state;
  bond_probe *p = bond_probe_new(&elastic_beam, values, &a_bond);
  const double h = 1e-6, length[PL_STATE_RESULTS] = {1, a_bond.s, a_bond.s};
  double tangent[PL_TANGENTS];
  bond_probe_tangent(p, (bond_motion){0, 0, 0, 0}, tangent);
  for (int q = 0; q < PL_STATE_RATES; q++) {
    double at[PL_STATE_RATES] = {0}, high[PL_STATE_RESULTS], low[PL_STATE_RESULTS];
    at[q] = h;
    bond_probe_forces(p, (bond_motion){at[0], at[1], at[2], at[3]}, high);
    bond_probe_forces(p, (bond_motion){-at[0], -at[1], -at[2], -at[3]}, low);
    for (int k = 0; k < PL_STATE_RESULTS; k++)
      assert_true(fabs(tangent[k * PL_STATE_RATES + q] - (high[k] - low[k]) / (2 * h)) <
                  1e-9 * EA() * length[k]);
  }
  near(tangent[0], EA(), 1e-12);
  bond_probe_free(p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(forces_are_those_of_the_law),
      cmocka_unit_test(fields_go_on_only_when_accepted),
      cmocka_unit_test(the_tangent_is_the_slope_of_the_forces),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
