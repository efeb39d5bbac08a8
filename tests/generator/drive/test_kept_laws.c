/* A law that is kept for many paths: what each of them sets is its own. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "generator/drive/driven_law.h"
#include "tests/generator/command_tools.h"

typedef struct keeper {
  workplace *w;
  arena *memory;
  source_set sources;
  diagnostics said;
  driven_law kept;
} keeper;

/* A quantity at the end of a path, on a law that is kept and on one that is not. */
static double final_value(keeper *k, const char *text, const char *quantity) {
  double value[2];
  char *path = arena_printf(k->memory, "%s/path.nml", k->w->folder);
  const int file = source_add(&k->sources, path, text, strlen(text));
  drive_input *in = drive_read(k->memory, &k->sources, file, NULL, 0, &k->said);
  assert_non_null(in);
  for (int own = 0; own < 2; own++) {
    driven_law of;
    drive_table t;
    drive_band band;
    const driven_outcome outcome =
        own ? driven_law_open(&of, k->memory, in, false, &k->said)
            : driven_law_open_kept(&of, &k->kept, k->memory, in, &k->said);
    assert_int_equal(outcome, DRIVEN_READY);
    assert_true(driven_law_march(&of, &t, &band));
    value[own] = t.columns[drive_column_find(&t, quantity)].values[t.rows - 1];
    drive_table_free(&t);
    driven_law_close(&of);
  }
  assert_true(value[0] == value[1]);
  return value[0];
}

static double final_force(keeper *k, const char *material) {
  char text[400];
  snprintf(text, sizeof text,
           "&material %s /\n&simulation steps = 10 /\n&bond spacing = '10 mm' thickness = '100 mm' "
           "/\n&path quantity = 'stretch' times = 0, '1 s' values = 0, 1e-4 /\n",
           material);
  return final_value(k, text, "N");
}

/* Of a bond of cohesive, in GN. */
static double final_cohesive(keeper *k, const char *bond) {
  char text[400];
  snprintf(text, sizeof text,
           "&material model = 'cohesive' E = '10 GPa' /\n&simulation steps = 10 /\n"
           "&bond spacing = '10 mm' thickness = '100 mm' %s /\n"
           "&path quantity = 'stretch' times = 0, '1 s' values = 0, 1e-6 /\n",
           bond);
  return final_value(k, text, "N");
}

/* Of a particle whose sides are held. */
static double final_stress(keeper *k, const char *particle) {
  char text[400];
  snprintf(text, sizeof text,
           "&material model = 'splm_elastic' E = '1 GPa' nu = 0.2 /\n&simulation steps = 10 /\n"
           "&particle spacing = '10 mm' %s /\n"
           "&path quantity = 'strain_xx' times = 0, '1 s' values = 0, 1e-6 /\n",
           particle);
  return final_value(k, text, "stress_xx");
}

static void each_path_has_its_own_values(void **state) {
  keeper k = {.w = *state, .memory = arena_new()};
  diag_begin(&k.said, &k.sources);
  static const char form[] = "model %s\n  law central bond\n  parameter E = 30 [GPa] in (0, inf)\n"
                             "  parameter rho = 2323 [kg/m^3] in (0, inf)\n%s"
                             "  force N = %s\nend model\n";
  char text[600];
  snprintf(text, sizeof text, form, "one", "", "E*s*t*stretch");
  write_text(k.w, "one.plm", text);
  snprintf(text, sizeof text, form, "other", "", "2*E*s*t*stretch");
  write_text(k.w, "other.plm", text);
  assert_true(fabs(final_force(&k, "model = 'one.plm'") - 3000) < 1e-6);
  assert_true(fabs(final_force(&k, "model = 'one.plm' E = '10 GPa'") - 1000) < 1e-6);
  assert_true(fabs(final_force(&k, "model = 'other.plm'") - 6000) < 1e-6);
  assert_true(fabs(final_force(&k, "model = 'one.plm'") - 3000) < 1e-6);
  driven_law_close(&k.kept);
  snprintf(text, sizeof text, form, "chosen", "  option size = single | double\n",
           "| E*s*t*stretch when size == single\n            | 2*E*s*t*stretch otherwise");
  write_text(k.w, "chosen.plm", text);
  assert_true(fabs(final_force(&k, "model = 'chosen.plm'") - 3000) < 1e-6);
  assert_true(fabs(final_force(&k, "model = 'chosen.plm' size = 'double'") - 6000) < 1e-6);
  driven_law_close(&k.kept);
  diag_clear(&k.said);
  source_clear(&k.sources);
  arena_free(k.memory);
}

/* Of bonds sqrt(3)/2 E s t and 4/(5 sqrt(2)) E s^2; of particles, in plane stress E/(1 - nu^2), in
   space E (1 - nu)/((1 + nu)(1 - 2 nu)). */
static void each_path_has_its_own_setting(void **state) {
  keeper k = {.w = *state, .memory = arena_new()};
  diag_begin(&k.said, &k.sources);
  const double plane = 1e3 / 0.96, space = 1e3 * 0.8 / (1.2 * 0.6);
  assert_true(fabs(final_stress(&k, "") / plane - 1) < 1e-5);
  assert_true(fabs(final_stress(&k, "lattice = 'fcc' shells = 2") / space - 1) < 1e-5);
  assert_true(fabs(final_stress(&k, "lattice = 'hexagonal'") / plane - 1) < 1e-5);
  driven_law_close(&k.kept);
  for (int turn = 0; turn < 2; turn++) {
    assert_true(fabs(final_cohesive(&k, "") / (5 * sqrt(3)) - 1) < 1e-9);
    assert_true(fabs(final_cohesive(&k, "setting = 'space'") / (4 / (5 * sqrt(2))) - 1) < 1e-9);
  }
  driven_law_close(&k.kept);
  assert_true(fabs(final_stress(&k, "lattice = 'fcc' shells = 2") / space - 1) < 1e-5);
  assert_true(fabs(final_stress(&k, "") / plane - 1) < 1e-5);
  driven_law_close(&k.kept);
  diag_clear(&k.said);
  source_clear(&k.sources);
  arena_free(k.memory);
}

int main(void) {
#define T(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {T(each_path_has_its_own_values),
                                     T(each_path_has_its_own_setting)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
