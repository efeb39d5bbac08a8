/* Every law of families planned for rows of sites with any number of neighbours, its text through both compilers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/kernel/compiled_family.h"

static int on_rows(const char *path, const law_choice *choice, law_setting setting) {
  check_family_law_in(path, choice, setting, false, 0, states_asked());
  return 1;
}

static int in_all_settings(const char *path, const law_choice *choice) {
  return check_settings(path, choice, on_rows);
}

static void kernels_of_any_number_of_neighbours_match(void **state) {
  (void)state;
  check_laws_of_families(in_all_settings);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_of_any_number_of_neighbours_match)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
