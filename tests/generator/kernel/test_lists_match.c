/* Every law of families planned for lists of neighbours of particles that stand on no lattice,
   whether its line `for` names these or not. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/kernel/compiled_family.h"

static bool suits_lists(const char *path, const law_choice *choice) {
  model m;
  assert_true(model_open(&m, path, choice, 1));
  const bool suits = model_suits_irregular(&m);
  model_close(&m);
  return suits;
}

static int on_lists(const char *path, const law_choice *choice, law_setting setting) {
  if (choice && !suits_lists(path, choice)) return 0;
  check_family_law_in(path, choice, setting, true, 0, states_asked() / 3);
  return 1;
}

static int in_all_settings(const char *path, const law_choice *choice) {
  return check_settings(path, choice, on_lists);
}

static void kernels_on_lists_match(void **state) {
  (void)state;
  check_laws_of_families(in_all_settings);
}

/* Laws that read `horizon` or `spacing`, where particles have their own. */
static void kernels_of_own_sizes_match(void **state) {
  (void)state;
  static const char *const paths[] = {"models/pmb.plm", "models/eps.plm"};
  for (int k = 0; k < 2; k++) {
    char path[4096], error[2000] = "";
    const char *note;
    model m;
    snprintf(path, sizeof path, SOURCE_DIR "/%s", paths[k]);
    assert_true(model_open(&m, path, NULL, 0));
    m.law = law_on_lattice(m.law, m.law->setting, true, 0);
    assert_true(model_plan_varying(&m, &(law_variation){.alone = true, .sizes = true}));
    const pl_law *kernel = model_kernel(&m, false, &note, error, sizeof error);
    assert_non_null(kernel);
    assert_int_equal(kernel->reads_own_size, 1);
    assert_same_families(m.plan, kernel, states_asked() / 3);
    model_close(&m);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_on_lists_match),
                                     cmocka_unit_test(kernels_of_own_sizes_match)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
