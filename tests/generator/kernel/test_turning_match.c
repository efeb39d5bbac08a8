/* Micropolar laws compiled for lattices that are no hexagon, in the plane and in space: kernel and
   interpreter, and the text through both compilers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/kernel/compiled_family.h"

/* `neighbours` 0: particles that stand on no lattice. `varying`: a parameter that differs from bond
   to bond, or NULL. */
static void check_law_with(const char *name, law_setting setting, int neighbours,
                           const char *varying) {
  model m;
  char path[4096], error[2000];
  const char *note;
  snprintf(path, sizeof path, "%s/%s.plm", SOURCE_DIR, name);
  assert_true(model_open(&m, path, NULL, 0));
  m.law = law_on_lattice(m.law, setting, neighbours == 0, neighbours);
  int which = 0;
  while (varying && strcmp(m.law->parameters.items[which]->name, varying) != 0)
    which++;
  const law_variation v = {.varying = &which, .varying_count = varying != NULL, .alone = true};
  if (!model_plan_of_families(&m, &v)) {
    diag_print(&m.said, stderr);
    fail_msg("%s cannot be planned", path);
  }
  const pl_law *kernel = model_kernel(&m, false, &note, error, sizeof error);
  if (!kernel) fail_msg("%s", error);
  assert_int_equal(kernel->dof, setting == SETTING_SPACE ? 6 : 3);
  assert_int_equal(kernel->topology, neighbours ? PL_ROWS : PL_LIST);
  /* on lattices a bond is evaluated once, and adds to both ends */
  assert_int_equal(kernel->sum_count > 0, neighbours > 0);
  assert_int_equal(kernel->varying_count, v.varying_count);
  assert_text_is_clean(&m);
  assert_same_families(m.plan, kernel, states_asked() / 12);
  model_close(&m);
}

static void check_law_on(const char *name, law_setting setting, int neighbours) {
  check_law_with(name, setting, neighbours, NULL);
}

static void kernels_in_the_plane_match(void **state) {
  (void)state;
  check_law_on("models/mplm_bilinear", SETTING_PLANE_STRESS, 4);
  check_law_on("models/mplm_linear", SETTING_PLANE_STRESS, 12);
  check_law_on("models/elastic_micropolar", SETTING_PLANE_STRESS, 28);
  check_law_on("tests/generator/laws/shear", SETTING_PLANE_STRESS, 8);
  check_law_with("tests/generator/laws/frame", SETTING_PLANE_STRESS, 0, "e_t");
}

static void kernels_in_space_match(void **state) {
  (void)state;
  check_law_on("models/mplm_space", SETTING_SPACE, 18);
  check_law_on("tests/generator/laws/solid_beam", SETTING_SPACE, 6);
  check_law_with("tests/generator/laws/frame", SETTING_SPACE, 12, "GJ");
  check_law_on("tests/generator/laws/frame", SETTING_SPACE, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_in_the_plane_match),
                                     cmocka_unit_test(kernels_in_space_match)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
