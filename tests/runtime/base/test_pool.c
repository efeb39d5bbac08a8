/* Memory of a run: aligned zeros, no two arrays in one place, also where one is larger than a
   piece. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/base/pool.h"
#include "runtime/kernel.h"

static const long counts[] = {0, 1, 7, 8, 9, 511, 512, 513, 100000, 5000000, 3, 4096, 1};
enum { COUNTS = sizeof counts / sizeof *counts };

static void arrays_are_zero_and_apart(void **state) {
  (void)state;
  pool *p = pool_new();
  double *array[COUNTS];
  for (int k = 0; k < COUNTS; k++) {
    array[k] = pool_doubles(p, counts[k]);
    assert_int_equal((uintptr_t)array[k] % PL_ALIGNMENT, 0);
    for (long n = 0; n < counts[k]; n++) {
      assert_true(array[k][n] == 0);
      array[k][n] = k + 1;
    }
  }
  for (int k = 0; k < COUNTS; k++)
    for (long n = 0; n < counts[k]; n++)
      assert_true(array[k][n] == k + 1);
  pool_free(p);
}

static void nothing_can_be_freed(void **state) {
  (void)state;
  pool_free(NULL);
  pool_free(pool_new());
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(arrays_are_zero_and_apart),
      cmocka_unit_test(nothing_can_be_freed),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
