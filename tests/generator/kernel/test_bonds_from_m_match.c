/* Laws of bonds in models/ whose names begin with letters from m: compiled kernels against the
   interpreter. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/kernel/bonds_kernel.h"

static void kernels_of_the_models_match(void **state) {
  (void)state;
  check_folder(SOURCE_DIR "/models/[m-z]*.plm", check_law_of_bonds);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_of_the_models_match)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
