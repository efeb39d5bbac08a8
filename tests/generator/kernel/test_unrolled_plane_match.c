/* Every law of families planned for the six neighbours of the hexagonal lattice, one by one. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/kernel/compiled_family.h"

static int unrolled(const char *path, const law_choice *choice, law_setting setting) {
  if (setting == SETTING_SPACE) return 0;
  check_family_law_in(path, choice, setting, false, 6, states_asked() / 4);
  return 1;
}

static int in_all_settings(const char *path, const law_choice *choice) {
  return check_settings(path, choice, unrolled);
}

static void unrolled_kernels_match(void **state) {
  (void)state;
  check_laws_of_families(in_all_settings);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(unrolled_kernels_match)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
