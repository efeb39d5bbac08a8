/* Laws of families in models/ whose names begin with letters from m, on lists: compiled kernels
   against the interpreter. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/kernel/lists_kernel.h"

static void kernels_of_the_models_match(void **state) {
  (void)state;
  check_folder(SOURCE_DIR "/models/[m-z]*.plm", on_lists_in_all_settings);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_of_the_models_match)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
