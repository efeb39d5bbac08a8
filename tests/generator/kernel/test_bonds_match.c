/* Every law of bonds beside the tests of kernels: its compiled kernel against the interpreter. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/kernel/bonds_kernel.h"

/* Central bonds, plastic states, outputs, energies, shear and all functions. */
static void kernels_of_the_test_laws_match(void **state) {
  (void)state;
  check_folder(SOURCE_DIR "/tests/generator/laws/*.plm", check_law_of_bonds);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_of_the_test_laws_match)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
