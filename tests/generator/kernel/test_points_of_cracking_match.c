/* Laws of a continuum in models/ before c: compiled kernels against
   the interpreter. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/kernel/points_kernel.h"

static void kernels_before_c_match(void **state) {
  (void)state;
  check_folder(SOURCE_DIR "/models/[ab]*.plm", check_law_of_points);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_before_c_match)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
