/* Kernels of other forms than their laws': laws of bonds as laws of families, loops cut in all
   ways, more fields than any law has needed; and faulty kernels, which are caught. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <float.h>
#include <unistd.h>

#include "dsl/semantics/law_variant.h"
#include "generator/emit/descriptor.h"
#include "generator/emit/emit.h"
#include "tests/generator/kernel/compiled_family.h"

/* A law of bonds compiled for lattices that are no hexagon. */
static void laws_of_bonds_match_as_laws_of_families(void **state) {
  (void)state;
  static const char *const names[] = {SOURCE_DIR "/models/cohesive.plm",
                                      SOURCE_DIR "/tests/generator/laws/leaning.plm",
                                      SOURCE_DIR "/tests/generator/laws/exponential.plm"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++)
    for (int space = 0; space < (k < 2 ? 2 : 1); space++) { /* the last reads a thickness */
      model m;
      char error[2000];
      assert_true(model_open(&m, names[k], NULL, 0));
      const char *note;
      m.law = law_on_lattice(m.law, space ? SETTING_SPACE : SETTING_PLANE_STRESS, false, 0);
      assert_true(model_plan_of_families(&m, &(law_variation){.alone = true}));
      const pl_law *kernel = model_kernel(&m, false, &note, error, sizeof error);
      if (!kernel) fail_msg("%s", error);
      assert_same_families(m.plan, kernel, 60000);
      model_close(&m);
    }
}

/* The plan's text with its loops cut as told, compiled; the same bits as the interpreter.
   Returns the text. */
static char *check_cut(model *m, loop_cutting cutting) {
  char error[2000];
  loaded_kernel loaded = {0};
  m->plan->cutting = cutting;
  char *unkeyed = emit_kernel(m->plan), *key = toolchain_key(unkeyed);
  char *text = descriptor_keyed(unkeyed, key);
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

static void tangent_of_no_moment(const pl_law *faulty, const double *uniforms, const pl_states *s) {
  good(faulty)->tangent(good(faulty), uniforms, s);
  memset(s->out[11], 0, (size_t)s->count * sizeof(double));
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
  const struct CMUnitTest tests[] = {cmocka_unit_test(laws_of_bonds_match_as_laws_of_families),
                                     cmocka_unit_test(kernels_match_however_loops_are_cut),
                                     cmocka_unit_test(many_fields_match),
                                     cmocka_unit_test(faults_are_caught),
                                     cmocka_unit_test(faults_of_families_are_caught),
                                     cmocka_unit_test(ulps_are_counted)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
