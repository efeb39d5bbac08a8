/* Subnormal numbers count as zero between the two calls, and as what they are outside. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/base/subnormals.h"

#if defined(__SSE2__) || defined(__aarch64__)
static void subnormals_are_zero_between_the_calls(void **state) {
  (void)state;
  volatile double smallest = 2.2250738585072014e-308, half = 0.5, subnormal = smallest * half;
  assert_true(subnormal > 0);
  const unsigned before = subnormals_off();
  volatile double made = smallest * half, read = subnormal * 4;
  const unsigned again = subnormals_off();
  subnormals_restore(again); /* as it was: still off */
  volatile double inside = smallest * half;
  subnormals_restore(before);
  assert_true(made == 0 && read == 0 && inside == 0);
  assert_true(smallest * half > 0 && subnormal > 0);
}
#endif

int main(void) {
#if defined(__SSE2__) || defined(__aarch64__)
  const struct CMUnitTest tests[] = {cmocka_unit_test(subnormals_are_zero_between_the_calls)};
  return cmocka_run_group_tests(tests, NULL, NULL);
#else
  return 0;
#endif
}
