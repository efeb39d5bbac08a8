/* Kernels of laws whose parameters differ in space against the interpreter, bit for bit: laws of
   families with a value on each particle and its share, laws of bonds as families with one on each
   bond; in every form that passes take. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "generator/lower/lowered.h"
#include "tests/generator/kernel/compiled_family.h"

enum { MOST_PARAMETERS = 16 };

typedef struct case_of {
  const char *law;
  law_setting setting;
  bool irregular;
  int neighbours;
  kernel_form form;
} case_of;

/* All parameters but the density, which belongs to the particles' masses. */
static law_variation all_of(const law *l, int *varying) {
  law_variation v = {.varying = varying, .shares = l->tree->law == LAW_STATE, .alone = true};
  for (int k = 0; k < l->parameters.count; k++)
    if (k != l->rho->index) varying[v.varying_count++] = k;
  return v;
}

static void check_case(const case_of *c) {
  model m;
  char path[4096], error[2000];
  const char *note;
  int varying[MOST_PARAMETERS];
  snprintf(path, sizeof path, SOURCE_DIR "/%s.plm", c->law);
  assert_true(model_open(&m, path, NULL, 0));
  m.law = law_on_lattice(m.law, c->setting, c->irregular, c->neighbours);
  const law_variation v = all_of(m.law, varying);
  assert_true(model_plan_of_families(&m, &v));
  assert_int_equal(m.plan->form, c->form);
  const pl_law *kernel = model_kernel(&m, false, &note, error, sizeof error);
  if (!kernel) fail_msg("%s", error);
  assert_int_equal(kernel->varying_count, v.varying_count);
  assert_int_equal(kernel->varying_place, v.shares ? PL_ON_PARTICLE : PL_ON_BOND);
  assert_int_equal(kernel->reads_share, v.shares);
  assert_same_families(m.plan, kernel, 20000);
  model_close(&m);
}

static void kernels_of_varying_parameters_match(void **state) {
  (void)state;
  static const case_of cases[] = {
      {"models/splm_elastic", SETTING_PLANE_STRESS, false, 6, FORM_UNROLLED},
      {"models/splm_elastic", SETTING_SPACE, true, 0, FORM_LOOPS},
      {"models/lps", SETTING_PLANE_STRAIN, false, 28, FORM_PAIRS},
      {"models/eps", SETTING_SPACE, false, 0, FORM_LOOPS},
      {"models/pmb", SETTING_SPACE, false, 18, FORM_PAIRS},
      {"models/cohesive", SETTING_PLANE_STRESS, true, 0, FORM_LOOPS},
      {"models/cohesive", SETTING_SPACE, false, 12, FORM_PAIRS},
      {"tests/generator/families/stored", SETTING_SPACE, false, 6, FORM_UNROLLED}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
    check_case(&cases[k]);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_of_varying_parameters_match)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
