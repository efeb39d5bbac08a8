/* Every law in models/ and beside this test: its compiled kernel against the interpreter, bit for
 * bit, and its text through both compilers. PERILAT_DEEP=1 takes ten times as many states. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <float.h>
#include <glob.h>
#include <math.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dsl/arena.h"
#include "generator/kernel_check.h"
#include "generator/model.h"

enum { PARAMETER_SETS = 4 };
static const pl_bond_class bonds = {.s = 6.35e-3,
                                    .spacing = 6.35e-3,
                                    .t = 0.1524,
                                    .V = 5.32e-6,
                                    .mass_i = 0.0124,
                                    .mass_j = 0.0124,
                                    .area = 1e-4,
                                    .shell = 1,
                                    .n = 6,
                                    .chord = {6.35e-3 * 0.5, 6.35e-3 * 0.8660254037844386, 0}};

static const pl_law *open_kernel(model *m, const char *path, const law_choice *choice) {
  char error[2000] = "";
  const char *note;
  if (!model_open(m, path, choice, choice ? 1 : 0) || !model_plan(m)) {
    diag_print(&m->said, stderr);
    fail_msg("%s cannot be compiled", path);
  }
  const pl_law *kernel = model_kernel(m, false, &note, error, sizeof error);
  if (!kernel) fail_msg("%s", error);
  assert_null(note);
  return kernel;
}

/* --- parameters ------------------------------------------------------------------------------- */

/* Set 0 are the defaults; the others vary each by a factor of up to 2 where its bounds let them. */
static double **parameter_sets(const pl_law *k) {
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

static kernel_check check(const model *m, const pl_law *kernel, long states) {
  double **sets = parameter_sets(kernel);
  kernel_check c = kernel_check_run(m->plan, kernel, (const double *const *)sets, PARAMETER_SETS,
                                    &bonds, states, 20);
  planes_free(sets, PARAMETER_SETS);
  return c;
}

/* --- the text --------------------------------------------------------------------------------- */

/* Compiles the kernel again with more flags; what the compiler says (malloc'ed), or NULL without
 * such a compiler. */
static char *compiler_says(const model *m, const char *compiler, const char *more) {
  char command[2000];
  snprintf(command, sizeof command, "%s --version >/dev/null 2>&1", compiler);
  if (system(command) != 0) return NULL;
  snprintf(command, sizeof command, "%s %s %s -o /dev/null -x c - 2>&1 <'%s/%s.c'", compiler,
           toolchain_flags(), more, toolchain_cache(), m->key);
  FILE *in = popen(command, "r");
  const size_t room = 1 << 20;
  char *said = must_calloc(room, 1);
  assert_true(fread(said, 1, room - 1, in) < room - 1);
  int status = pclose(in);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail_msg("%s: %s", command, said);
  return said;
}

static void assert_clean_and_vectorised(const model *m) {
  const char *text = m->c_text, *loop = strstr(strstr(text, "static void rows("), "for (long q");
  char expected[64];
  int line = 1;
  for (const char *c = text; c < loop; c++)
    line += *c == '\n';
  snprintf(expected, sizeof expected, ":%d:3: optimized: loop vectorized", line);
  char *gcc = compiler_says(m, "gcc", "-Wall -Wextra -Werror -fopt-info-vec-optimized");
  if (gcc && !strstr(gcc, expected))
    fail_msg("the main loop of %s does not vectorise: %s", m->path, gcc);
  free(gcc);
  free(compiler_says(m, "clang", "-Wall -Wextra -Werror -Wno-unused-command-line-argument"));
}

/* --- all models ------------------------------------------------------------------------------- */

static void assert_same_bits(const model *m, const pl_law *kernel, long states) {
  kernel_check c = check(m, kernel, states);
  for (int k = 0; k < m->law->options.count; k++)
    printf("%s = %s: ", m->law->options.items[k]->name, m->law->chosen[k]);
  kernel_check_report(&c, kernel->name, stdout);
  fflush(stdout);
  assert_int_equal(c.outputs.unwritten, 0);
  assert_int_equal(c.outputs.misplaced, 0);
  assert_true(c.outputs.largest_ulps == 0);
  assert_true(kernel_check_agrees(&c));
  assert_int_equal(c.guards_both, c.guards);
}

static void check_kernel(const model *m, const pl_law *kernel, long states) {
  assert_clean_and_vectorised(m);
  assert_same_bits(m, kernel, states);
}

/* Each choice of each option once, the other options at their first. */
static void check_model(const char *path) {
  const long states = getenv("PERILAT_DEEP") ? 1000000 : 120000;
  model m, chosen;
  check_kernel(&m, open_kernel(&m, path, NULL), states);
  for (int k = 0; k < m.law->options.count; k++) {
    const symbol *option = m.law->options.items[k];
    for (int w = 1; w < option->declared->word_count; w++) {
      law_choice choice = {option->name, option->declared->words[w]};
      check_kernel(&chosen, open_kernel(&chosen, path, &choice), states);
      model_close(&chosen);
    }
  }
  model_close(&m);
}

static void check_folder(const char *pattern) {
  glob_t models;
  assert_int_equal(glob(pattern, 0, NULL, &models), 0);
  assert_true(models.gl_pathc > 0);
  for (size_t k = 0; k < models.gl_pathc; k++)
    check_model(models.gl_pathv[k]);
  globfree(&models);
}

static void kernels_of_the_models_match(void **state) {
  (void)state;
  check_folder(SOURCE_DIR "/models/*.plm");
}

/* Central bonds, plastic states, outputs, energies, shear and all functions. */
static void kernels_of_the_test_laws_match(void **state) {
  (void)state;
  check_folder(SOURCE_DIR "/tests/generator/laws/*.plm");
}

/* More fields and parameters than any law has needed yet. */
static void many_fields_match(void **state) {
  (void)state;
  enum { MANY = 70 };
  char path[] = "/tmp/perilat_XXXXXX.plm";
  FILE *out = fdopen(mkstemps(path, 4), "w");
  assert_non_null(out);
  fprintf(out, "model many\n  law central bond\n  parameter rho = 1 [kg/m^3] in (0, inf)\n");
  for (int k = 0; k < MANY; k++)
    fprintf(out, "  parameter k%d = %d [N] in (0, inf)\n", k, k + 1);
  for (int k = 0; k < MANY; k++)
    fprintf(out, "  damage d%d on bond = max(d%d, positive_part(min(1, %d*stretch)))\n", k, k,
            k + 1);
  fprintf(out, "  force N = stretch*((1 - d0)*k0");
  for (int k = 1; k < MANY; k++)
    fprintf(out, " + (1 - d%d)*k%d", k, k);
  fprintf(out, ")\nend model\n");
  fclose(out);
  model m;
  const pl_law *kernel = open_kernel(&m, path, NULL);
  unlink(path);
  assert_int_equal(kernel->field_count, MANY);
  assert_same_bits(&m, kernel, 10000);
  model_close(&m);
}

/* --- faulty kernels are caught ---------------------------------------------------------------- */

/* Each stands in for a function of the compiled kernel, which is behind `context`. */
static const pl_law *good(const pl_law *faulty) {
  return faulty->context;
}

static void rows_one_ulp_off(const pl_law *faulty, const double *uniforms, const pl_strip *s) {
  good(faulty)->rows(good(faulty), uniforms, s);
  for (long q = 0; q < s->count; q++)
    if (s->force[0][q] != 0) {
      s->force[0][q] = nextafter(s->force[0][q], INFINITY);
      return;
    }
}

static void observes_nothing(const pl_law *faulty, const double *uniforms, const pl_strip *s) {
  (void)faulty, (void)uniforms, (void)s;
}

static void loads_absent_bonds(const pl_law *faulty, const double *uniforms, const pl_strip *s) {
  good(faulty)->list_ledger(good(faulty), uniforms, s);
  for (long q = 0; q < s->count; q++)
    if (!(s->flags[q] & PL_PRESENT(s->direction))) s->force[1][q] = 1e-300;
}

static void breaks_protected_bonds(const pl_law *faulty, const double *uniforms,
                                   const pl_strip *s) {
  good(faulty)->list(good(faulty), uniforms, s);
  for (long q = 0; q < s->count; q++)
    if (s->flags[q] & PL_PROTECTED(s->direction)) s->field[0][q] += 0.5;
}

static void tangent_of_no_moment(const pl_law *faulty, const double *uniforms, long count,
                                 const double *const *in, double *const *out) {
  good(faulty)->tangent(good(faulty), uniforms, count, in, out);
  memset(out[11], 0, (size_t)count * sizeof(double));
}

static void bounds_all_open(const pl_law *faulty, const double *parameters, double *lower,
                            double *upper, unsigned char *low_open, unsigned char *high_open) {
  good(faulty)->bounds(good(faulty), parameters, lower, upper, low_open, high_open);
  memset(low_open, 1, (size_t)faulty->parameter_count);
}

static kernel_check check_faulty(const model *m, pl_law faulty, const pl_law *kernel) {
  faulty.context = kernel;
  kernel_check c = check(m, &faulty, 20000);
  assert_false(kernel_check_agrees(&c));
  return c;
}

/* The kernel's table with one function replaced. */
#define WITH(function, fault)                                                                      \
  check_faulty(&m, (faulty = *kernel, faulty.function = (fault), faulty), kernel)

static void faults_are_caught(void **state) {
  (void)state;
  model m;
  const pl_law *kernel = open_kernel(&m, SOURCE_DIR "/models/mplm_bilinear.plm", NULL);
  pl_law faulty;
  kernel_check c = WITH(rows, rows_one_ulp_off);
  assert_true(c.outputs.largest_ulps == 1);
  assert_string_equal(c.outputs.worst, "rows: force 0");
  assert_int_equal(c.outputs.unwritten + c.outputs.misplaced, 0);
  assert_true(WITH(rows_observe, observes_nothing).outputs.unwritten > 1000);
  assert_true(WITH(list_ledger, loads_absent_bonds).outputs.misplaced > 100);
  assert_true(WITH(list, breaks_protected_bonds).outputs.misplaced > 100);
  assert_string_equal(WITH(tangent, tangent_of_no_moment).outputs.worst, "tangent: derivative 11");
  assert_string_equal(WITH(bounds, bounds_all_open).outputs.worst, "bounds: low_open");
  model_close(&m);
}

static void ulps_are_counted(void **state) {
  (void)state;
  assert_true(ulps_between(1, nextafter(1, 2)) == 1 && ulps_between(nextafter(1, 0), 1) == 1);
  assert_true(ulps_between(DBL_MAX, nextafter(DBL_MAX, 0)) == 1 && ulps_between(0, 5e-324) == 1);
  assert_true(ulps_between(0, -0.0) == 0 && ulps_between(NAN, NAN) == 0);
  assert_true(isinf(ulps_between(NAN, 1)) && isinf(ulps_between(INFINITY, 1)));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(kernels_of_the_models_match),
      cmocka_unit_test(kernels_of_the_test_laws_match), cmocka_unit_test(many_fields_match),
      cmocka_unit_test(faults_are_caught), cmocka_unit_test(ulps_are_counted)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
