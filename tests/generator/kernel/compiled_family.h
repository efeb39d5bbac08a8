/* Compiled kernels of laws of families against the interpreter: families of many bonds, and a
   law in every setting that it names, planned in one way. Each way is a test of its own, since
   compilers take their time. */
#ifndef PERILAT_TESTS_COMPILED_FAMILY_H
#define PERILAT_TESTS_COMPILED_FAMILY_H

#include "tests/generator/kernel/compiled_kernel.h"

/* Bonds of many lengths in all directions, in opposite pairs. */
static inline void family_of(pl_bond_class *family, int dimensions, int neighbours) {
  const int half = neighbours / 2;
  for (int k = 0; k < half; k++) {
    const double turn = 2.399963 * k, up = dimensions == 3 ? (k + 0.5) / half : 0;
    const double s = bonds.s * (1 + 0.5 * (k % 4)), flat = s * sqrt(1 - up * up);
    family[k] = bonds;
    family[k].s = s;
    family[k].shell = 1 + k % 4;
    family[k].n = neighbours;
    family[k].chord[0] = flat * cos(turn);
    family[k].chord[1] = flat * sin(turn);
    family[k].chord[2] = s * up;
    family[k + half] = family[k];
    for (int d = 0; d < 3; d++)
      family[k + half].chord[d] = -family[k].chord[d];
  }
}

static inline kernel_check check_family(const kernel_plan *p, const pl_law *kernel, int neighbours,
                                        long states) {
  pl_bond_class family[2 * PL_MAX_DIRECTIONS];
  double **sets = parameter_sets(kernel);
  family_of(family, kernel->dimensions, neighbours);
  kernel_check c = kernel_check_run(p, kernel, (const double *const *)sets, PARAMETER_SETS, family,
                                    neighbours, states, 20);
  planes_free(sets, PARAMETER_SETS);
  return c;
}

static inline void assert_same_families(const kernel_plan *p, const pl_law *kernel, long states) {
  static const int any[] = {6, 18, 122};
  const int *neighbours = kernel->neighbours ? &kernel->neighbours : any;
  const int of_rows = kernel->neighbours ? 1 : 3;
  /* a list has no other code for more */
  const int sizes = kernel->topology == PL_LIST ? 2 : of_rows;
  for (int k = 0; k < sizes; k++) {
    kernel_check c = check_family(p, kernel, neighbours[k], states);
    printf("%d dimensions, %d neighbours: ", kernel->dimensions, neighbours[k]);
    kernel_check_report(&c, kernel->name);
    fflush(stdout);
    const int step =
        kernel->ledger.pass_count ? kernel->ledger.pass_count : kernel->step.pass_count;
    assert_true(step >= kernel->step.pass_count);
    assert_true(kernel->force_state.pass_count > 0);
    assert_int_equal(c.passes, step + kernel->observe.pass_count + kernel->force_state.pass_count);
    assert_true(c.bonds > 0);
    assert_true(kernel_check_agrees(&c));
  }
}

/* `neighbours`: what the law is planned for; 0: any. */
static inline void check_family_law_in(const char *path, const law_choice *choice,
                                       law_setting setting, bool irregular, int neighbours,
                                       long states) {
  model m;
  const pl_law *kernel = open_kernel_for(&m, path, choice, &setting, irregular, neighbours);
  assert_int_equal(kernel->neighbours, m.plan->form == FORM_UNROLLED ? neighbours : 0);
  assert_int_equal(kernel->topology, irregular ? PL_LIST : PL_ROWS);
  if (choice) printf("%s = %s, ", choice->option, choice->choice);
  if (irregular) printf("irregular, ");
  if (!choice) assert_text_is_clean(&m);
  assert_same_families(m.plan, kernel, states);
  model_close(&m);
}

/* What is done with a law in one setting. Returns how many kernels were checked. */
typedef int family_test(const char *path, const law_choice *choice, law_setting setting);

/* In every setting that a law of families names. */
static inline int check_settings(const char *path, const law_choice *choice, family_test *test) {
  int checked = 0;
  for (int k = SETTING_PLANE_STRESS; k <= SETTING_SPACE; k++) {
    model m;
    char meant[96];
    assert_true(model_open(&m, path, choice, choice ? 1 : 0));
    const bool asked = m.law->tree->law == LAW_STATE &&
                       model_suits(&m, law_setting_name((law_setting)k), meant, sizeof meant);
    model_close(&m);
    if (asked) checked += test(path, choice, (law_setting)k);
  }
  return checked;
}

/* The models that come along, and those of the tests: damage, slip, energies and values of
   neighbours of neighbours, in the plane and in space. */
static inline void check_laws_of_families(law_test *test) {
  check_folder(SOURCE_DIR "/models/*.plm", test);
  check_folder(SOURCE_DIR "/tests/generator/families/*.plm", test);
}

#endif
