/* Compiled kernels against the interpreter, bit for bit: a law opened and compiled, random
   states and parameters for it, and its text through both C compilers. PERILAT_DEEP=1 takes ten
   times as many states. */
#ifndef PERILAT_TESTS_COMPILED_KERNEL_H
#define PERILAT_TESTS_COMPILED_KERNEL_H

#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include "dsl/base/arena.h"
#include "dsl/semantics/law_variant.h"
#include "generator/kernel/kernel_check.h"
#include "generator/kernel/model.h"
#include "generator/kernel/toolchain_cache.h"
#include "generator/kernel/toolchain_compiler.h"
#include "generator/lower/lowered.h"

enum { PARAMETER_SETS = 4 };
static const pl_bond_class bonds = {.size = sizeof(pl_bond_class),
                                    .s = 6.35e-3,
                                    .spacing = 6.35e-3,
                                    .t = 0.1524,
                                    .V = 5.32e-6,
                                    .mass_i = 0.0124,
                                    .mass_j = 0.0124,
                                    .area = 1e-4,
                                    .shell = 1,
                                    .n = 6,
                                    .chord = {6.35e-3 * 0.5, 6.35e-3 * 0.8660254037844386, 0}};

static inline const pl_law *open_kernel_for(model *m, const char *path, const law_choice *choice,
                                            const law_setting *setting, bool irregular,
                                            int neighbours) {
  char error[2000] = "";
  const char *note;
  bool good = model_open(m, path, choice, choice ? 1 : 0);
  if (good)
    m->law = law_on_lattice(m->law, setting ? *setting : m->law->setting, irregular, neighbours);
  if (!good || !model_plan_varying(m, &(law_variation){.alone = true})) {
    diag_print(&m->said, stderr);
    fail_msg("%s cannot be compiled", path);
  }
  const pl_law *kernel = model_kernel(m, false, &note, error, sizeof error);
  if (!kernel) fail_msg("%s", error);
  assert_null(note);
  return kernel;
}

static inline const pl_law *open_kernel(model *m, const char *path, const law_choice *choice) {
  return open_kernel_for(m, path, choice, NULL, false, 0);
}

/* --- parameters ------------------------------------------------------------------------------- */

/* Set 0 are the defaults; the others vary each by a factor of up to 2 where its bounds let them. */
static inline double **parameter_sets(const pl_law *k) {
  const int count = k->parameter_count;
  double **sets = planes_new(PARAMETER_SETS, count), **bound = planes_new(2, count);
  unsigned char *open = must_calloc(2 * (size_t)count + 1, 1);
  for (int set = 0; set < PARAMETER_SETS; set++)
    for (int p = 0; p < count; p++)
      sets[set][p] = k->parameters[p].has_default ? k->parameters[p].initial : 1;
  for (int set = 1; set < PARAMETER_SETS; set++)
    for (int p = 0; p < count; p++) {
      k->bounds(k, sets[set], bound[0], bound[1], open, open + count);
      double wanted = sets[set][p] * exp2(sin(7 * set + p));
      if (wanted > bound[0][p] && wanted < bound[1][p]) sets[set][p] = wanted;
    }
  planes_free(bound, 2);
  free(open);
  return sets;
}

static inline kernel_check check(const model *m, const pl_law *kernel, long states) {
  double **sets = parameter_sets(kernel);
  kernel_check c = kernel_check_run(m->plan, kernel, (const double *const *)sets, PARAMETER_SETS,
                                    &bonds, 1, states, 20);
  planes_free(sets, PARAMETER_SETS);
  return c;
}

/* --- the text --------------------------------------------------------------------------------- */

/* Compiles the kernel again with more flags; what the compiler says (malloc'ed), or NULL without
 * such a compiler. */
static inline char *compiler_says(model *m, const char *compiler, const char *more) {
  char command[2000];
  snprintf(command, sizeof command, "%s --version >/dev/null 2>&1", compiler);
  if (system(command) != 0) return NULL;
  snprintf(command, sizeof command, "%s %s %s -o /dev/null -x c - 2>&1 <'%s/%s.c'", compiler,
           toolchain_flags(), more, toolchain_cache(), model_key(m));
  FILE *in = popen(command, "r");
  const size_t room = 1 << 20;
  char *said = must_calloc(room, 1);
  assert_true(fread(said, 1, room - 1, in) < room - 1);
  int status = pclose(in);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail_msg("%s: %s", command, said);
  return said;
}

static inline void assert_text_is_clean(model *m) {
  free(compiler_says(m, "gcc", "-Wall -Wextra -Werror"));
  free(compiler_says(m, "clang", "-Wall -Wextra -Werror -Wno-unused-command-line-argument"));
}

/* --- many laws -------------------------------------------------------------------------------- */

static inline long states_asked(void) {
  return getenv("PERILAT_DEEP") ? 1000000 : 120000;
}

/* What is done with a law for one choice of its options (NULL: the first of each). Returns how
   many kernels were checked. */
typedef int law_test(const char *path, const law_choice *choice);

/* Each choice of each option once, the other options at their first. */
static inline int check_model(const char *path, law_test *test) {
  model m;
  int checked = test(path, NULL);
  assert_true(model_open(&m, path, NULL, 0));
  for (int k = 0; k < m.law->options.count; k++) {
    const symbol *option = m.law->options.items[k];
    for (int w = 1; w < option->declared->word_count; w++)
      checked += test(path, &(law_choice){option->name, option->declared->words[w]});
  }
  model_close(&m);
  return checked;
}

static inline void check_folder(const char *pattern, law_test *test) {
  glob_t models;
  int checked = 0;
  assert_int_equal(glob(pattern, 0, NULL, &models), 0);
  for (size_t k = 0; k < models.gl_pathc; k++)
    checked += check_model(models.gl_pathv[k], test);
  globfree(&models);
  assert_true(checked > 0);
}

/* --- laws of bonds ---------------------------------------------------------------------------- */

static inline void assert_same_bits(const model *m, const pl_law *kernel, long states) {
  kernel_check c = check(m, kernel, states);
  for (int k = 0; k < m->law->options.count; k++)
    printf("%s = %s: ", m->law->options.items[k]->name, m->law->chosen[k]);
  kernel_check_report(&c, kernel->name);
  fflush(stdout);
  assert_int_equal(c.outputs.unwritten, 0);
  assert_int_equal(c.outputs.misplaced, 0);
  assert_true(c.outputs.largest_ulps == 0);
  assert_true(kernel_check_agrees(&c));
  assert_int_equal(c.guards_both, c.guards);
}

#endif
