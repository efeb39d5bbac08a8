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

#include "dsl/base/arena.h"
#include "generator/emit/emit.h"
#include "generator/kernel/kernel_check.h"
#include "generator/kernel/model.h"

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

static const pl_law *open_kernel_for(model *m, const char *path, const law_choice *choice,
                                     const law_setting *setting, bool irregular, int neighbours) {
  char error[2000] = "";
  const char *note;
  bool good = model_open(m, path, choice, choice ? 1 : 0);
  if (good && setting) m->law->setting = *setting;
  if (good) m->law->irregular = irregular;
  if (good) m->law->neighbours = neighbours;
  if (!good || !model_plan(m)) {
    diag_print(&m->said, stderr);
    fail_msg("%s cannot be compiled", path);
  }
  const pl_law *kernel = model_kernel(m, false, &note, error, sizeof error);
  if (!kernel) fail_msg("%s", error);
  assert_null(note);
  return kernel;
}

static const pl_law *open_kernel(model *m, const char *path, const law_choice *choice) {
  return open_kernel_for(m, path, choice, NULL, false, 0);
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
                                    &bonds, 1, states, 20);
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

static void assert_vectorised(const model *m, const char *gcc, const char *function) {
  const char *text = m->c_text, *at = strstr(text, function),
             *end = at ? strstr(at, "\n}\n") : NULL;
  /* All loops of the function: */
  while (end && (at = strstr(at, "  PL_INDEPENDENT\n")) && at < end) {
    char expected[64];
    int line = 2;
    for (const char *c = text; c < at; c++)
      line += *c == '\n';
    snprintf(expected, sizeof expected, ":%d:3: optimized: loop vectorized", line);
    if (gcc && !strstr(gcc, expected))
      fail_msg("line %d of the kernel of %s does not vectorise: %s", line, m->path, gcc);
    at++;
  }
}

static void assert_clean_and_vectorised(const model *m) {
  char *gcc = compiler_says(m, "gcc", "-Wall -Wextra -Werror -fopt-info-vec-optimized");
  assert_non_null(strstr(m->c_text, "PL_PASS void rows(const pl_law *law"));
  assert_vectorised(m, gcc, "PL_PASS void rows(const pl_law *law");
  /* Where something is expected: */
  assert_vectorised(m, gcc, "PL_PASS void rows_unusual(const pl_law *law");
  free(gcc);
  free(compiler_says(m, "clang", "-Wall -Wextra -Werror -Wno-unused-command-line-argument"));
}

/* --- all models ------------------------------------------------------------------------------- */

static void assert_same_bits(const model *m, const pl_law *kernel, long states) {
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

static void check_kernel(const model *m, const pl_law *kernel, long states) {
  assert_clean_and_vectorised(m);
  assert_same_bits(m, kernel, states);
}

/* --- families --------------------------------------------------------------------------------- */

/* Bonds of many lengths in all directions, in opposite pairs. */
static void family_of(pl_bond_class *family, int dimensions, int neighbours) {
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

static kernel_check check_family(const kernel_plan *p, const pl_law *kernel, int neighbours,
                                 long states) {
  pl_bond_class family[2 * PL_MAX_DIRECTIONS];
  double **sets = parameter_sets(kernel);
  family_of(family, kernel->dimensions, neighbours);
  kernel_check c = kernel_check_run(p, kernel, (const double *const *)sets, PARAMETER_SETS, family,
                                    neighbours, states, 20);
  planes_free(sets, PARAMETER_SETS);
  return c;
}

static void assert_same_families(const kernel_plan *p, const pl_law *kernel, long states) {
  static const int any[] = {6, 18, 122};
  const int *neighbours = kernel->neighbours ? &kernel->neighbours : any;
  const int rows = kernel->neighbours ? 1 : 3;
  const int sizes = kernel->topology == PL_LIST ? 2 : rows; /* a list has no other code for more */
  for (int k = 0; k < sizes; k++) {
    kernel_check c = check_family(p, kernel, neighbours[k], states);
    printf("%d dimensions, %d neighbours: ", kernel->dimensions, neighbours[k]);
    kernel_check_report(&c, kernel->name);
    fflush(stdout);
    assert_int_equal(c.passes, kernel->step.pass_count + kernel->observe.pass_count);
    assert_true(c.bonds > 0);
    assert_true(kernel_check_agrees(&c));
  }
}

static void assert_text_is_clean(const model *m) {
  free(compiler_says(m, "gcc", "-Wall -Wextra -Werror"));
  free(compiler_says(m, "clang", "-Wall -Wextra -Werror -Wno-unused-command-line-argument"));
}

/* `neighbours`: what the law is planned for; 0: any. */
static void check_family_law_in(const char *path, const law_choice *choice, law_setting setting,
                                bool irregular, int neighbours, long states) {
  model m;
  const pl_law *kernel = open_kernel_for(&m, path, choice, &setting, irregular, neighbours);
  assert_int_equal(kernel->neighbours, m.plan->form == FAMILY_WRITTEN_OUT ? neighbours : 0);
  assert_int_equal(kernel->topology, irregular ? PL_LIST : PL_ROWS);
  if (choice) printf("%s = %s, ", choice->option, choice->choice);
  if (irregular) printf("irregular, ");
  if (!choice) assert_text_is_clean(&m);
  assert_same_families(m.plan, kernel, states);
  model_close(&m);
}

/* Planned for a large family: bonds add to both ends where these would compute the same. */
static void check_large_family(const char *path, law_setting setting, long states) {
  enum { LARGE = 122 };
  model m;
  char error[2000];
  const char *note;
  assert_true(model_open(&m, path, NULL, 0));
  m.law->setting = setting;
  m.law->neighbours = LARGE;
  assert_true(model_plan(&m));
  const pl_law *kernel = model_kernel(&m, false, &note, error, sizeof error);
  if (!kernel) fail_msg("%s", error);
  assert_text_is_clean(&m);
  kernel_check c = check_family(m.plan, kernel, LARGE, states);
  printf("%d dimensions, %d neighbours, %d sums: ", kernel->dimensions, LARGE, kernel->sum_count);
  kernel_check_report(&c, kernel->name);
  assert_true(kernel_check_agrees(&c));
  model_close(&m);
}

/* In every setting that the law names, on rows and on lists (whether it names these or not); the text goes through both
   compilers with the first choices. */
static void check_family_law(const char *path, const law_choice *choice, long states) {
  for (int k = SETTING_PLANE_STRESS; k <= SETTING_SPACE; k++) {
    model m;
    assert_true(model_open(&m, path, choice, choice ? 1 : 0));
    char meant[96];
    const bool allowed = model_suits(&m, law_setting_name((law_setting)k), meant, sizeof meant);
    const bool on_lists = !choice || model_suits_irregular(&m);
    model_close(&m);
    if (!allowed) continue;
    check_family_law_in(path, choice, (law_setting)k, false, 0, states);
    check_family_law_in(path, choice, (law_setting)k, false, k == SETTING_SPACE ? 12 : 6,
                        states / 4);
    if (!choice) check_large_family(path, (law_setting)k, states / 3);
    if (on_lists) check_family_law_in(path, choice, (law_setting)k, true, 0, states / 3);
  }
}

static void check_law(const char *path, const law_choice *choice) {
  const long states = getenv("PERILAT_DEEP") ? 1000000 : 120000;
  model m;
  bool good = model_open(&m, path, choice, choice ? 1 : 0);
  const bool of_families = good && m.law->tree->law == LAW_STATE;
  model_close(&m);
  if (of_families) {
    check_family_law(path, choice, states);
    return;
  }
  check_kernel(&m, open_kernel(&m, path, choice), states);
  model_close(&m);
}

/* Each choice of each option once, the other options at their first. */
static void check_model(const char *path) {
  model m;
  check_law(path, NULL);
  assert_true(model_open(&m, path, NULL, 0));
  for (int k = 0; k < m.law->options.count; k++) {
    const symbol *option = m.law->options.items[k];
    for (int w = 1; w < option->declared->word_count; w++)
      check_law(path, &(law_choice){option->name, option->declared->words[w]});
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

/* Damage, slip, energies and values of neighbours of neighbours, in the plane and in space. */
static void kernels_of_the_family_laws_match(void **state) {
  (void)state;
  check_folder(SOURCE_DIR "/tests/generator/families/*.plm");
}

/* A law of bonds compiled for lattices that are no hexagon. */
static void laws_of_bonds_match_as_laws_of_families(void **state) {
  (void)state;
  static const char *const names[] = {SOURCE_DIR "/models/cohesive.plm",
                                      SOURCE_DIR "/tests/generator/laws/exponential.plm"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++)
    for (int space = 0; space < (k == 0 ? 2 : 1); space++) { /* the other reads a thickness */
      model m;
      char error[2000];
      assert_true(model_open(&m, names[k], NULL, 0));
      m.law->setting = space ? SETTING_SPACE : SETTING_PLANE_STRESS;
      m.plan = plan_kernel_of_families(m.law, &m.said);
      assert_non_null(m.plan);
      char *unkeyed = emit_kernel(m.plan, "");
      m.key = toolchain_key(unkeyed);
      free(unkeyed);
      m.c_text = emit_kernel(m.plan, m.key);
      if (!toolchain_load(m.c_text, m.key, &m.loaded, error, sizeof error)) fail_msg("%s", error);
      assert_same_families(m.plan, m.loaded.law, 60000);
      model_close(&m);
    }
}

/* The plan's text with its loops cut as told, compiled; the same bits as the interpreter. Returns the text. */
static char *check_cut(model *m, loop_cutting cutting) {
  char error[2000];
  loaded_kernel loaded = {0};
  m->plan->cutting = cutting;
  char *unkeyed = emit_kernel(m->plan, ""), *key = toolchain_key(unkeyed);
  char *text = emit_kernel(m->plan, key);
  if (!toolchain_load(text, key, &loaded, error, sizeof error)) fail_msg("%s", error);
  assert_same_bits(m, loaded.law, 120000);
  toolchain_unload(&loaded);
  free(key);
  free(text);
  return unkeyed;
}

static void kernels_match_however_loops_are_cut(void **state) {
  (void)state;
  static const char *const names[] = {"mplm_bilinear", "cohesive", "mplm_linear"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    model m;
    char path[4096];
    snprintf(path, sizeof path, "%s/models/%s.plm", SOURCE_DIR, names[k]);
    assert_true(model_open(&m, path, NULL, 0) && model_plan(&m));
    char *whole = check_cut(&m, CUT_NEVER), *cut = check_cut(&m, CUT_ALWAYS);
    assert_string_not_equal(whole, cut);
    free(whole);
    free(cut);
    model_close(&m);
  }
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
  good(faulty)->rows_ledger(good(faulty), uniforms, s);
  for (long q = 0; q < s->count; q++)
    if (!(s->flags[q] & PL_PRESENT(s->direction))) s->force[1][q] = 1e-300;
}

static void breaks_protected_bonds(const pl_law *faulty, const double *uniforms,
                                   const pl_strip *s) {
  good(faulty)->rows(good(faulty), uniforms, s);
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
  assert_true(WITH(rows_ledger, loads_absent_bonds).outputs.misplaced > 100);
  assert_true(WITH(rows, breaks_protected_bonds).outputs.misplaced > 100);
  assert_string_equal(WITH(tangent, tangent_of_no_moment).outputs.worst, "tangent: derivative 11");
  assert_string_equal(WITH(bounds, bounds_all_open).outputs.worst, "bounds: low_open");
  model_close(&m);
}

static void family_one_ulp_off(const pl_law *faulty, const double *uniforms, const pl_family *f) {
  good(faulty)->step.pass[1](good(faulty), uniforms, f);
  for (long q = 0; q < f->count; q++)
    if (f->force[0][q] != 0) {
      f->force[0][q] = nextafter(f->force[0][q], INFINITY);
      return;
    }
}

static void family_without_forces(const pl_law *faulty, const double *uniforms,
                                  const pl_family *f) {
  (void)faulty, (void)uniforms, (void)f;
}

static void family_that_breaks_what_is_held(const pl_law *faulty, const double *uniforms,
                                            const pl_family *f) {
  good(faulty)->step.pass[0](good(faulty), uniforms, f);
  for (long q = 0; q < f->count; q++)
    if (f->held[q]) f->new_field[0][q] = 0.123;
}

static kernel_check check_faulty_family(const model *m, pl_law faulty, const pl_law *kernel,
                                        int number, pl_family_function fault) {
  pl_family_function passes[PLAN_MOST_PASSES];
  memcpy(passes, kernel->step.pass, (size_t)kernel->step.pass_count * sizeof *passes);
  for (int k = 0; k < kernel->step.pass_count; k++)
    assert_non_null(passes[k]);
  passes[number] = fault;
  faulty.step.pass = passes;
  faulty.context = kernel;
  return check_family(m->plan, &faulty, 6, 4000);
}

static void faults_of_families_are_caught(void **state) {
  (void)state;
  model m;
  const pl_law *kernel = open_kernel(&m, SOURCE_DIR "/tests/generator/families/brittle.plm", NULL);
  assert_int_equal(kernel->step.pass_count, 2);
  assert_string_equal(kernel->fields[0].name, "w");
  kernel_check c = check_faulty_family(&m, *kernel, kernel, 1, family_one_ulp_off);
  assert_true(c.outputs.largest_ulps == 1);
  assert_string_equal(c.outputs.worst, "step: force 0");
  c = check_faulty_family(&m, *kernel, kernel, 1, family_without_forces);
  assert_true(c.outputs.unwritten > 1000 && !kernel_check_agrees(&c));
  c = check_faulty_family(&m, *kernel, kernel, 0, family_that_breaks_what_is_held);
  assert_true(c.outputs.misplaced > 40 && !kernel_check_agrees(&c));
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
  const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_of_the_models_match),
                                     cmocka_unit_test(kernels_of_the_test_laws_match),
                                     cmocka_unit_test(kernels_of_the_family_laws_match),
                                     cmocka_unit_test(laws_of_bonds_match_as_laws_of_families),
                                     cmocka_unit_test(kernels_match_however_loops_are_cut),
                                     cmocka_unit_test(many_fields_match),
                                     cmocka_unit_test(faults_are_caught),
                                     cmocka_unit_test(faults_of_families_are_caught),
                                     cmocka_unit_test(ulps_are_counted)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
