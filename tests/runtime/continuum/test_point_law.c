/* A law at a single point against Hooke's closed forms in plane stress. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "runtime/continuum/point_law.h"
#include "tests/runtime/continuum/hooke_law.h"

static const double E = 30e9, NU = 0.2;
static const double parameters[] = {30e9, 0.2, 2400};

/* Pulled along x and free to contract along y: sigma = E eps, energy E eps^2/2. */
static void test_uniaxial_stress(void **state) {
  const double eps = 1e-4, strain[3] = {eps, -NU * eps, 0};
  double stress[4], energy;
  point_law *p = point_law_new(&hooke_law, parameters);
  (void)state;
  point_law_stress(p, strain, 1, stress);
  point_law_observe(p, strain, 1, &energy);
  assert_true(fabs(stress[0] - E * eps) <= 1e-9 * E * eps);
  for (int k = 1; k < 4; k++)
    assert_true(fabs(stress[k]) <= 1e-9 * E * eps);
  assert_true(fabs(energy - (0.5 * E * eps * eps)) <= 1e-9 * E * eps * eps);
  point_law_free(p);
}

/* The change of angle is twice the tensor's shear; the tangent takes the change of angle. */
static void test_shear(void **state) {
  const double mu = E / (2 * (1 + NU)), strain[3] = {0, 0, 1e-4};
  double stress[4], D[3][3];
  point_law *p = point_law_new(&hooke_law, parameters);
  (void)state;
  point_law_stress(p, strain, 1, stress);
  point_law_tangent(p, strain, 1, D);
  assert_true(fabs(stress[2] - (2 * mu * 1e-4)) <= 1e-9 * mu);
  assert_true(fabs(D[2][2] - mu) <= 1e-9 * mu);
  assert_true(fabs(D[0][1] - (NU * E / (1 - NU * NU))) <= 1e-9 * E);
  point_law_free(p);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_uniaxial_stress),
                                     cmocka_unit_test(test_shear)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
