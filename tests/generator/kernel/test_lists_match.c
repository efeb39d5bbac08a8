/* Laws of families of the tests, and laws whose particles have sizes of their own, on lists:
   compiled kernels against the interpreter. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/kernel/lists_kernel.h"

static void kernels_on_lists_match(void **state) {
  (void)state;
  check_folder(SOURCE_DIR "/tests/generator/families/*.plm", on_lists_in_all_settings);
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
