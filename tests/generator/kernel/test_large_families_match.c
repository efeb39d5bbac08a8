/* Every law of families planned for large families: bonds add to both ends where these would
   compute the same. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dsl/semantics/law_variant.h"
#include "tests/generator/kernel/compiled_family.h"

/* Planned for a large family: bonds add to both ends where these would compute the same. */
static int large(const char *path, const law_choice *choice, law_setting setting) {
  enum { LARGE = 122 };
  if (choice) return 0;
  model m;
  char error[2000];
  const char *note;
  assert_true(model_open(&m, path, NULL, 0));
  m.law = law_on_lattice(m.law, setting, false, LARGE);
  assert_true(model_plan_varying(&m, &(law_variation){.alone = true}));
  const pl_law *kernel = model_kernel(&m, false, &note, error, sizeof error);
  if (!kernel) fail_msg("%s", error);
  assert_text_is_clean(&m);
  kernel_check c = check_family(m.plan, kernel, LARGE, states_asked() / 3);
  printf("%d dimensions, %d neighbours, %d sums: ", kernel->dimensions, LARGE, kernel->sum_count);
  kernel_check_report(&c, kernel->name);
  assert_true(kernel_check_agrees(&c));
  model_close(&m);
  return 1;
}

static int in_all_settings(const char *path, const law_choice *choice) {
  return check_settings(path, choice, large);
}

static void kernels_of_large_families_match(void **state) {
  (void)state;
  check_laws_of_families(in_all_settings);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_of_large_families_match)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
