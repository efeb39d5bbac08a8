/* The bilinear map of a quadrilateral: its inverse, area, and which are convex. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/base/random_number.h"
#include "runtime/geometry/quadrilateral.h"

static const double panel[4][2] = {{0, 0}, {48, 44}, {48, 60}, {0, 44}};

static void the_inverse_leads_back(void **state) {
  (void)state;
  for (int k = 0; k < 1000; k++) {
    const double u[2] = {1.2 * random_unit(random_mix((uint64_t)k)) - 0.1,
                         1.2 * random_unit(random_mix((uint64_t)k + 5000)) - 0.1};
    double at[2], slope[2][2], back[2];
    quadrilateral_map(panel, u, at, slope);
    quadrilateral_unmap(panel, at, back);
    assert_true(fabs(back[0] - u[0]) < 1e-13 && fabs(back[1] - u[1]) < 1e-13);
  }
}

static void slopes_are_those_of_the_map(void **state) {
  (void)state;
  const double u[2] = {0.3, 0.6}, h = 1e-6;
  double at[2], slope[2][2], there[2], other[2][2];
  quadrilateral_map(panel, u, at, slope);
  for (int k = 0; k < 2; k++) {
    const double moved[2] = {u[0] + (k ? 0 : h), u[1] + (k ? h : 0)};
    quadrilateral_map(panel, moved, there, other);
    for (int a = 0; a < 2; a++)
      assert_true(fabs((there[a] - at[a]) / h - slope[a][k]) < 1e-6);
  }
}

static void area_and_box_are_known(void **state) {
  (void)state;
  double lower[2], upper[2];
  assert_true(fabs(quadrilateral_area(panel) - 0.5 * (44 + 16) * 48) < 1e-12);
  quadrilateral_box(panel, lower, upper);
  assert_true(lower[0] == 0 && lower[1] == 0 && upper[0] == 48 && upper[1] == 60);
}

static void turns_tell_what_is_convex(void **state) {
  (void)state;
  const double dart[4][2] = {{0, 0}, {2, 0}, {0.5, 0.5}, {0, 2}},
               clockwise[4][2] = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  for (int k = 0; k < 4; k++) {
    assert_true(quadrilateral_turn(panel, k) > 0);
    assert_true((quadrilateral_turn(dart, k) > 0) == (k != 2));
    assert_true(quadrilateral_turn(clockwise, k) < 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_inverse_leads_back), cmocka_unit_test(slopes_are_those_of_the_map),
      cmocka_unit_test(area_and_box_are_known), cmocka_unit_test(turns_tell_what_is_convex)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
