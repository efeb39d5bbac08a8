/* Laws of very many cases: their loops are written and compiled so that a C compiler takes linear
   time, and compute what the interpreter does, bit for bit. Ordinary laws know nothing of it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "generator/emit/emit.h"
#include "tests/generator/kernel/compiled_family.h"

enum { CASES = 160 };
static const char options_of_large[] = "#pragma GCC optimize(\"O1\", \"tree-vectorize\",";

/* A damage of CASES lines, each with a condition and a function of its own, of the stretch `x`. */
static void write_damage(FILE *out, const char *x) {
  fprintf(out, "    | 0 when %s <= 1e-4\n", x);
  for (int k = 1; k < CASES; k++)
    fprintf(out, "    | 1 - exp(-(%s - 1e-4)/%.4e) when %s <= %.4e\n", x, 4e-4 + 1e-6 * k, x,
            1e-4 + 1e-5 * k);
  fprintf(out, "    | 1 otherwise\n");
}

static const char head[] = "  parameter E   = 30 [GPa]       in (0, inf)  \"modulus\"\n"
                           "  parameter rho = 2323 [kg/m^3]  in (0, inf)  \"density\"\n";

static void write_bond(const char *path) {
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  fprintf(out,
          "model long_cases\n  law central bond\n%s"
          "  constant EA = sqrt(3)/2*E*s*t\n  damage omega =\n",
          head);
  write_damage(out, "stretch");
  fprintf(out, "  force N = | EA*stretch              when stretch < 0\n"
               "            | (1 - omega)*EA*stretch  otherwise\nend model\n");
  assert_int_equal(fclose(out), 0);
}

static void write_family(const char *path) {
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  fprintf(out,
          "model long_family\n  law state\n  for plane_stress, space, irregular\n%s"
          "  damage D on particle\n  k = max(stretch[j])\n  D =\n",
          head);
  write_damage(out, "k");
  fprintf(out, "  c = E/sum(s*V[j])\n  force state T[j] = (1 - D)*c*stretch[j]\n"
               "  energy W = sum((1 - D)*c*stretch[j]**2*s*V*V[j])/2\nend model\n");
  assert_int_equal(fclose(out), 0);
}

static void assert_written_for_time(model *m) {
  char *text = emit_kernel(m->plan);
  assert_true(m->plan->large);
  assert_non_null(strstr(text, options_of_large));
  assert_null(strstr(text, "const double EA = uniforms[")); /* read where they are used */
  assert_null(strstr(text, "void rows_unusual"));           /* no loop stands there twice */
  free(text);
}

/* Names of a function's lines that wait at most for a later line, as a reader counts them. */
static int waiting_at_most(const char *text, const char *function) {
  enum { MOST = 20000 };
  const char *c = strstr(text, function), *end = c ? strstr(c, "\n}\n") : NULL;
  static const char *last[MOST];
  static const char *made[MOST];
  int count = 0, now = 0, most = 0;
  assert_non_null(end);
  for (const char *at = c; (at = strstr(at, "const double v")) && at < end; at++) {
    char name[40];
    size_t length = strspn(at + 13, "v0123456789");
    snprintf(name, sizeof name, "%.*s", (int)length, at + 13);
    made[count] = last[count] = at;
    for (const char *use = at; (use = strstr(use + 1, name)) && use < end;)
      if (!strspn(use + length, "0123456789")) last[count] = use;
    assert_true(++count < MOST);
  }
  for (int k = 0; k < count; k++) {
    now = 0;
    for (int l = 0; l <= k; l++)
      now += last[l] > made[k];
    most = now > most ? now : most;
  }
  assert_true(count > CASES);
  return most;
}

static void bonds_of_many_cases_match(void **state) {
  (void)state;
  model m;
  write_bond("long_cases.plm");
  const pl_law *kernel = open_kernel(&m, "long_cases.plm", NULL);
  assert_written_for_time(&m);
  char *text = emit_kernel(m.plan);
  assert_true(waiting_at_most(text, "void rows(const pl_law *law") < 16);
  free(text);
  const kernel_check c = check(&m, kernel, 20000);
  kernel_check_report(&c, "long_cases");
  assert_true(kernel_check_agrees(&c));
  model_close(&m);
}

/* Neighbours that would be written out stand in a loop. */
static void families_of_many_cases_match(void **state) {
  (void)state;
  static const struct {
    law_setting setting;
    int neighbours;
  } on[] = {{SETTING_PLANE_STRESS, 6}, {SETTING_SPACE, 12}};
  char error[2000];
  const char *note;
  write_family("long_family.plm");
  for (size_t k = 0; k < sizeof on / sizeof *on; k++) {
    model m;
    assert_true(model_open(&m, "long_family.plm", NULL, 0));
    m.law = law_on_lattice(m.law, on[k].setting, false, on[k].neighbours);
    assert_true(model_plan_of_families(&m, &(law_variation){.alone = true}));
    assert_int_equal(m.plan->form, FORM_LOOPS);
    assert_written_for_time(&m);
    const pl_law *kernel = model_kernel(&m, false, &note, error, sizeof error);
    if (!kernel) fail_msg("%s", error);
    assert_same_families(m.plan, kernel, 5000);
    model_close(&m);
  }
}

static void ordinary_laws_are_as_they_were(void **state) {
  (void)state;
  static const char *const laws[] = {"mplm_bilinear", "splm_concrete", "brittle_cracking"};
  for (size_t k = 0; k < sizeof laws / sizeof *laws; k++) {
    model m;
    char path[4096];
    snprintf(path, sizeof path, SOURCE_DIR "/models/%s.plm", laws[k]);
    assert_true(model_open(&m, path, NULL, 0));
    assert_true(model_plan_varying(&m, &(law_variation){.alone = true}));
    char *text = emit_kernel(m.plan);
    assert_false(m.plan->large);
    assert_null(strstr(text, "tree-vectorize"));
    free(text);
    model_close(&m);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(bonds_of_many_cases_match),
                                     cmocka_unit_test(families_of_many_cases_match),
                                     cmocka_unit_test(ordinary_laws_are_as_they_were)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
