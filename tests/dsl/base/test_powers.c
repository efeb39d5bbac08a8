/* Whole powers are the nearest doubles, decades are exact, and the factors of units are made from
   them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/powers.h"
#include "dsl/base/units.h"

static double ten_to(int n) {
  char text[16];
  snprintf(text, sizeof text, "1e%d", n);
  return strtod(text, NULL);
}

static void powers_of_ten_are_exact(void **state) {
  (void)state;
  for (int n = -64; n <= 64; n++)
    assert_true(power_of(10, n) == ten_to(n));
}

static void decades_are_exact(void **state) {
  (void)state;
  for (int n = -320; n <= 308; n++) {
    assert_int_equal(decade_of(ten_to(n)), n);
    assert_int_equal(decade_of(nextafter(ten_to(n), INFINITY)), n);
    if (n > -320) assert_int_equal(decade_of(nextafter(ten_to(n), 0)), n - 1);
  }
}

/* Against 64 bits of mantissa: at most 0.51 ulp off, and whole results are exact. */
static void whole_powers_round_once(void **state) {
  (void)state;
  double worst = 0;
  for (int k = 1; k < 2000; k++)
    for (int n = -20; n <= 20; n++) {
      const double x = 0.01 * k, got = power_of(x, n);
      const long double exact = powl((long double)x, n);
      const double off = (double)fabsl(((long double)got - exact) / ldexpl(1, ilogbl(exact) - 52));
      worst = fmax(worst, off);
    }
  print_message("largest error %.3f ulp\n", worst);
  assert_true(worst < 0.51);
  assert_true(power_of(3, 20) == 3486784401.0 && power_of(-2, -3) == -0.125);
}

static void ends_of_the_range(void **state) {
  (void)state;
  assert_true(power_of(0, 0) == 1 && power_of(0, 3) == 0 && power_of(0, -1) == INFINITY);
  assert_true(power_of(1e300, 2) == INFINITY && power_of(1e-300, 2) == 0);
  assert_true(power_of(1e-300, -2) == INFINITY && power_of(1e300, -2) == 0);
  assert_true(power_of(0x1p-500, 2) == 0x1p-1000 && power_of(0x1p500, -2) == 0x1p-1000);
  assert_true(power_of(INFINITY, 2) == INFINITY && power_of(INFINITY, -2) == 0);
  assert_true(isnan(power_of(NAN, 2)) && isnan(power_of(-8, 1.0 / 3)));
  assert_true(power_of(4, 0.5) == 2 && power_of(2, 1000) == 0x1p1000);
}

static double factor_of(const char *text) {
  unit u;
  const char *bad;
  size_t length;
  assert_true(unit_parse(text, strlen(text), &u, &bad, &length));
  return u.factor;
}

static void units_have_exact_factors(void **state) {
  (void)state;
  assert_true(factor_of("mm^3") == 1e-9 && factor_of("mm^2") == 1e-6 && factor_of("kPa^2") == 1e6);
  assert_true(factor_of("m^(1/2)") == 1 && factor_of("ms^-2") == 1e6);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(powers_of_ten_are_exact),  cmocka_unit_test(decades_are_exact),
      cmocka_unit_test(whole_powers_round_once),  cmocka_unit_test(ends_of_the_range),
      cmocka_unit_test(units_have_exact_factors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
