/* Sums of products of the playground beside the processor's own, which round once. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "generator/playground/fused.h"
#include "runtime/base/random_number.h"

enum { TRIES = 1000000 };

static uint64_t drawn;

static uint64_t draw(void) {
  return random_mix(++drawn);
}

/* Any sign and digits, half of them few, sizes from 2^-range to 2^range. */
static double number(int range) {
  const uint64_t sign = draw() << 63, exponent = 1023 + draw() % (2 * (uint64_t)range + 1);
  uint64_t digits = draw() >> 12;
  if (draw() & 1) digits &= ~UINT64_C(0) << draw() % 52;
  return pl_from_bits(sign | (exponent - (uint64_t)range) << 52 | digits);
}

static void compare(double a, double b, double c) {
  if (!fused_is_safe(a, b, c)) return;
  const double here = fused_safe(a, b, c), there = fma(a, b, c);
  if (pl_to_bits(here) != pl_to_bits(there))
    fail_msg("%a * %a + %a: %a, not %a", a, b, c, here, there);
}

static void sums_round_once(void **state) {
  static const int ranges[] = {1, 10, 60, 399};
  (void)state;
  for (int k = 0; k < TRIES; k++) {
    const int range = ranges[k % 4];
    compare(number(range), number(range), number(range));
    compare(number(range), number(range), number(2 * range));
  }
}

/* Nearly nothing is left: the rest of the product counts; and ties that it decides. */
static void rests_count(void **state) {
  (void)state;
  for (int k = 0; k < TRIES; k++) {
    const double a = number(20), b = number(20), product = a * b;
    compare(a, b, -product);
    compare(a, b, nextafter(-product, 0));
    compare(a, b, product * (double)(draw() % 64));
    compare(a, b, ldexp(product, 53));
    compare(a, b, -ldexp(product, 54));
    compare(a, b, ldexp(number(0), (int)(draw() % 200) - 100));
    compare(a, b, 0x1p-1074 * (double)(draw() % 5));
  }
}

/* Just below and just above half of the last digit of c, which is odd. */
static void halves_are_told(void **state) {
  (void)state;
  for (int k = 0; k < TRIES; k++) {
    const double a = pl_abs(number(0)), below = 0x1p-53 * ((1 - 0x1p-53) / a),
                 above = 0x1p-53 * ((1 + 0x1p-52) / a);
    compare(a, below, 0x1.0000000000001p0);
    compare(-a, below, -0x1.0000000000001p0);
    compare(a, above, 1);
    compare(-a, above, -1);
  }
}

static void unsafe_is_refused(void **state) {
  (void)state;
  assert_true(fused_is_safe(3, -0.25, 0));
  assert_false(fused_is_safe(0x1p-500, 0x1p-400, 1));
  assert_false(fused_is_safe(0x1p500, 1, 1));
  assert_false(fused_is_safe(1, 1, 0x1p1000));
  assert_false(fused_is_safe(0, 1, 1));
  assert_false(fused_is_safe(NAN, 1, 1));
  assert_false(fused_is_safe(1, INFINITY, 1));
  assert_false(fused_is_safe(1, 1, NAN));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sums_round_once), cmocka_unit_test(rests_count),
      cmocka_unit_test(halves_are_told), cmocka_unit_test(unsafe_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
