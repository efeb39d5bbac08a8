/* Direction and size of the largest hoop stress, against known values and their definition. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/crack/hoop_stress.h"

static void known_values(void **state) {
  (void)state;
  const double K[4][2] = {{1, .3}, {1, 1}, {0, 1}, {-.5, 1}},
               degrees[] = {-29.103, -53.130, -70.529, -80.266},
               size[] = {1.11867, 1.78885, 1.15470, .90686};
  for (int k = 0; k < 4; k++) {
    const double angle = hoop_angle(K[k]);
    assert_true(fabs(angle * 180 / M_PI - degrees[k]) < 0.51e-3);
    assert_true(fabs(hoop_intensity(K[k], angle) - size[k]) < 0.51e-5);
  }
}

/* No shear on the plane of largest hoop stress: K_I sin + K_II (3 cos - 1) = 0; nearby it is
   less. */
static void it_is_the_largest(void **state) {
  (void)state;
  for (int k = -20; k <= 20; k++) {
    const double K[2] = {1, 0.11 * k}, mirrored[2] = {1, -0.11 * k}, a = hoop_angle(K);
    assert_true(fabs(K[0] * sin(a) + K[1] * (3 * cos(a) - 1)) < 1e-12);
    assert_true(fabs(hoop_angle(mirrored) + a) < 1e-15);
    assert_true(hoop_intensity(K, a) >= hoop_intensity(K, a + 0.01));
    assert_true(hoop_intensity(K, a) >= hoop_intensity(K, a - 0.01));
  }
  assert_true(hoop_angle((double[2]){0, 0}) == 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(known_values),
                                     cmocka_unit_test(it_is_the_largest)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
