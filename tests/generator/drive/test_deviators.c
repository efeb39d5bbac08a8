/* States that are deviators beside the same laws with states that are tensors: fields, stresses,
   states, outputs and tangents along walks drawn by chance, and what a step costs. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/semantics/law_variant.h"
#include "generator/drive/driven_point.h"
#include "generator/ir/random_values.h"
#include "generator/kernel/model.h"

enum { MOST = PL_MAX_STRAINS, LONGEST = 1 << 16 };

/* --- one law, with `tensor` or `deviator` ----------------------------------------------------- */

typedef struct opened {
  model m;
  driven_point point;
  double parameters[16];
} opened;

/* `text` with the word in the place of each @. */
static void open_text(opened *o, const char *text, const char *word, law_setting setting) {
  char *written = calloc(1, LONGEST), error[2000];
  size_t length = 0;
  const char *note;
  for (; *text; text++)
    length += (size_t)(*text == '@' ? snprintf(written + length, LONGEST - length, "%s", word)
                                    : snprintf(written + length, LONGEST - length, "%c", *text));
  if (!model_open_text(&o->m, "law.plm", written, length, NULL, 0)) {
    diag_print(&o->m.said, stderr);
    fail_msg("the law with `%s` is refused", word);
  }
  free(written);
  o->m.law = law_on_lattice(o->m.law, setting, false, 0);
  assert_true(model_plan(&o->m));
  const pl_law *kernel = model_kernel(&o->m, true, &note, error, sizeof error);
  assert_non_null(kernel);
  assert_true(kernel->parameter_count <= 16);
  for (int k = 0; k < kernel->parameter_count; k++)
    o->parameters[k] = kernel->parameters[k].initial;
  driven_point_open(&o->point, kernel, o->parameters, 0.01);
}

static void close_text(opened *o) {
  driven_point_close(&o->point);
  model_close(&o->m);
}

/* models/von_mises.plm with @ in the place of its word. */
static char *von_mises_text(void) {
  static const char word[] = "deviator 0";
  char *text = calloc(1, LONGEST);
  FILE *in = fopen(SOURCE_DIR "/models/von_mises.plm", "rb");
  assert_non_null(in);
  assert_true(fread(text, 1, LONGEST - 1, in) > 0);
  fclose(in);
  char *at = strstr(text, word);
  assert_non_null(at);
  *at = '@';
  memmove(at + 1, at + strlen("deviator"), strlen(at + strlen("deviator")) + 1);
  return text;
}

/* Each operation that makes a deviator, and each that reads one. */
static const char everything[] =
    "model everything\n"
    "  law continuum\n"
    "  for plane_stress, plane_strain, space\n"
    "  parameter E   = 2 [GPa]        in (0, inf)\n"
    "  parameter nu  = 0.2            in [0, 0.5)\n"
    "  parameter k   = 0.3            in (0, 1)\n"
    "  parameter rho = 2400 [kg/m^3]  in (0, inf)\n"
    "  constant mu = E/(2*(1 + nu))\n"
    "  function part(x) = x/3\n"
    "  state a on point = @ 0\n"
    "  state b on point = @ 0\n"
    "  state c on point = @ 0\n"
    "  s = hooke(strain - a - 2*b, E, nu)\n"
    "  t = 2*mu*dev(strain - a) - 0.3*E*b\n"
    "  a = a + k*dev(strain - previous(a)) - previous(b)/7\n"
    "  b = | part(a)                    when strain[x,x] > 1e-3\n"
    "      | -a/2 + dev(dev(s))/(5*E)   when strain[y,y] > 0\n"
    "      | 0                          when strain[x,y] > 2e-3\n"
    "      | 2*previous(b)/3            otherwise\n"
    "  flow c by k*(dev(s)/E - (c - a)) when strain[x,y] > 0\n"
    "  stress sigma = hooke(strain - a, E, nu) - k*E*(b + c)\n"
    "  output equivalent = von_mises(t)\n"
    "  output of_sum     = von_mises(strain - a + b)\n"
    "  output second     = J2(b - c)\n"
    "  output size       = norm(c)\n"
    "  output volume     = trace(strain - a) + trace(b)\n"
    "  output across     = a[z,z] + 2*b[z,z] + 3*c[z,z]\n"
    "  output first      = principal(a + c, 1)\n"
    "  output last       = principal(b, 3)\n"
    "  output directed   = principal_direction(a, 1) : c\n"
    "  output both       = a : b\n"
    "  output mixed      = c : strain\n"
    "  w = | 2*(strain - a)  when strain[x,x] > 0\n"
    "      | strain - 3*b    otherwise\n"
    "  output turned     = trace(-(strain - a))\n"
    "  output of_cases   = trace(w)\n"
    "  output squares    = trace(product(a, c))\n"
    "  output slope      = norm(dev(diff((c : c)/2 + 3*(c : strain) + c[x,y]*c[z,z], c)))\n"
    "end model\n";

/* A flow that is solved for, whose guard knows the old value, too. */
static const char returned[] = "model returned_flow\n"
                               "  law continuum\n"
                               "  for plane_stress, plane_strain, space\n"
                               "  parameter E   = 2 [GPa]        in (0, inf)\n"
                               "  parameter nu  = 0.2            in [0, 0.5)\n"
                               "  parameter f_y = 1 [MPa]        in (0, inf)\n"
                               "  parameter H   = 0.2 [GPa]      in (0, inf)\n"
                               "  parameter rho = 2400 [kg/m^3]  in (0, inf)\n"
                               "  constant mu = E/(2*(1 + nu))\n"
                               "  state e on point = @ 0\n"
                               "  s     = 2*mu*dev(strain - e) - H*e\n"
                               "  yield f = norm(s) - f_y - H*norm(e - previous(e))\n"
                               "  flow  e along s/max(norm(s), 1 [Pa]) returned when f >= 0\n"
                               "  stress sigma = hooke(strain - e, E, nu)\n"
                               "  output over = norm(2*mu*dev(strain - e) - H*e)\n"
                               "end model\n";

static double draw_walk(uint64_t *seed, int step, int strains, double *by, double *strain) {
  double size = 0;
  for (int k = 0; k < strains; k++) {
    if (step % 10 == 0) by[k] = draw_uniform(seed, -4e-4, 4e-4);
    strain[k] += by[k];
    size = fmax(size, fabs(strain[k]));
  }
  return size;
}

static int field_of(const pl_law *kernel, const char *name) {
  for (int k = 0; k < kernel->field_count; k++)
    if (strcmp(kernel->fields[k].name, name) == 0) return k;
  return -1;
}

static void assert_close(double a, double b, double size, const char *what, int step) {
  if (!(fabs(a - b) <= 1e-11 * size)) fail_msg("%s: %.17g and %.17g in step %d", what, a, b, step);
}

/* The states of `d` are those of `t`, and zz of each deviator is what the others leave. */
static void compare_fields(const opened *d, const opened *t, double size, int step) {
  const pl_law *kernel = d->point.kernel;
  for (int k = 0; k < kernel->field_count; k++) {
    const int same = field_of(t->point.kernel, kernel->fields[k].name);
    assert_true(same >= 0);
    assert_close(d->point.old_field[k][0], t->point.old_field[same][0], size,
                 kernel->fields[k].name, step);
  }
  for (int k = 0; k < t->point.kernel->field_count; k++) {
    char name[32];
    const size_t length = strlen(t->point.kernel->fields[k].name);
    snprintf(name, sizeof name, "%s", t->point.kernel->fields[k].name);
    if (strcmp(name + length - 3, "_zz") != 0) continue;
    assert_int_equal(field_of(kernel, name), -1);
    name[length - 1] = name[length - 2] = 'x';
    const double xx = d->point.old_field[field_of(kernel, name)][0];
    name[length - 1] = name[length - 2] = 'y';
    const double yy = d->point.old_field[field_of(kernel, name)][0];
    assert_close(t->point.old_field[k][0], -(xx + yy), size, "zz", step);
  }
}

static void compare_step(opened *d, opened *t, const strained *at, double size, int step) {
  const double E = d->parameters[0];
  double of_d[MOST][MOST], of_t[MOST][MOST];
  driven_point_tangent(&d->point, at, of_d);
  driven_point_tangent(&t->point, at, of_t);
  for (int k = 0; k < d->point.strains; k++)
    for (int q = 0; q < d->point.strains; q++)
      assert_close(of_d[k][q], of_t[k][q], 10 * E, "tangent", step);
  const stressed a = driven_point_step(&d->point, at), b = driven_point_step(&t->point, at);
  for (int k = 0; k < d->point.stresses; k++)
    assert_close(a.stress[k], b.stress[k], E * size, "stress", step);
  driven_point_accept(&d->point);
  driven_point_accept(&t->point);
  compare_fields(d, t, size, step);
  driven_point_observe(&d->point, at);
  driven_point_observe(&t->point, at);
  for (int k = 0; k < d->point.kernel->output_count; k++) {
    const bool pressure = strcmp(d->point.kernel->outputs[k].unit, "Pa") == 0;
    assert_close(d->point.observed[1 + k][0], t->point.observed[1 + k][0],
                 size * (pressure ? E : 1), d->point.kernel->outputs[k].name, step);
  }
}

/* Both along one walk, from rest. */
static void walk_beside(const char *text, law_setting setting, uint64_t seed) {
  opened d, t;
  open_text(&d, text, "deviator", setting);
  open_text(&t, text, "tensor", setting);
  double by[MOST] = {0}, most = 1e-3;
  strained at = {.step = 1};
  for (int step = 0; step < 120; step++) {
    most = fmax(most, draw_walk(&seed, step, d.point.strains, by, at.strain));
    compare_step(&d, &t, &at, most, step);
  }
  close_text(&d);
  close_text(&t);
}

static const law_setting settings[] = {SETTING_PLANE_STRESS, SETTING_PLANE_STRAIN, SETTING_SPACE};

static void deviators_are_tensors(void **state) {
  (void)state;
  char *steel = von_mises_text();
  for (int k = 0; k < 3; k++) {
    walk_beside(everything, settings[k], 5);
    walk_beside(everything, settings[k], 6);
    walk_beside(steel, settings[k], 7);
    walk_beside(returned, settings[k], 8);
  }
  free(steel);
}

/* A derivative by a deviator is one: of W = c : strain the deviator of the strain. */
static void derivatives_by_deviators_have_no_trace(void **state) {
  static const char text[] = "model slopes\n"
                             "  law continuum\n"
                             "  for plane_stress, plane_strain, space\n"
                             "  parameter E   = 2 [GPa]        in (0, inf)\n"
                             "  parameter nu  = 0.2            in [0, 0.5)\n"
                             "  parameter rho = 2400 [kg/m^3]  in (0, inf)\n"
                             "  state c on point = @ 0\n"
                             "  c = dev(strain)/2\n"
                             "  g = diff(c : strain, c)\n"
                             "  stress sigma = hooke(strain - c, E, nu)\n"
                             "  output left   = g[x,x] + g[y,y] + g[z,z]\n"
                             "  output beside = norm(g - dev(strain))\n"
                             "end model\n";
  const double strain[MOST] = {3e-3, -2e-3, 1.2e-3, 0.9e-3, -0.4e-3, 0.7e-3};
  (void)state;
  for (int k = 0; k < 3; k++) {
    opened o;
    strained at = {.step = 1};
    open_text(&o, text, "deviator", settings[k]);
    memcpy(at.strain, strain, sizeof at.strain);
    driven_point_observe(&o.point, &at);
    for (int q = 1; q <= 2; q++)
      assert_true(fabs(o.point.observed[q][0]) < 1e-17);
    close_text(&o);
  }
}

/* --- what is kept and what it costs ----------------------------------------------------------- */

static void zz_is_no_field(void **state) {
  static const char *const names[] = {"eps_bar",  "eps_p_xx", "eps_p_yy",
                                      "eps_p_xy", "eps_p_yz", "eps_p_xz"};
  (void)state;
  opened o;
  char *steel = von_mises_text();
  open_text(&o, steel, "deviator", SETTING_SPACE);
  assert_int_equal(o.point.kernel->field_count, 6);
  for (int k = 0; k < 6; k++)
    assert_string_equal(o.point.kernel->fields[k].name, names[k]);
  close_text(&o);
  free(steel);
}

static double operations_of(const char *text, const char *word, law_setting setting) {
  opened o;
  open_text(&o, text, word, setting);
  const double count = o.point.kernel->flops_per_bond + o.point.kernel->divisions_per_bond;
  close_text(&o);
  return count;
}

/* In plane strain a step of von Mises takes no mean off its trial stress (5 additions, 2
   multiplications of each of 3 components at least), and keeps one component less (a fused
   multiplication and addition of trial, square, state and stress each). */
static void deviators_cost_less(void **state) {
  (void)state;
  char *steel = von_mises_text();
  for (int k = 0; k < 3; k++) {
    const double less = operations_of(steel, "deviator", settings[k]),
                 more = operations_of(steel, "tensor", settings[k]);
    if (less > more - 15) fail_msg("%g operations, not %g less 15", less, more);
  }
  free(steel);
}

/* A return that is found costs no more than the closed form: before it flows the law is looked at
   without what flows. */
static void returns_cost_what_closed_forms_do(void **state) {
  static const char form[] = "model steel\n"
                             "  law continuum\n"
                             "  for plane_stress, plane_strain, space\n"
                             "  parameter E   = 200 [GPa]  in (0, inf)\n"
                             "  parameter nu  = 0.3  in [0, 0.5)\n"
                             "  parameter f_y = 250 [MPa]  in (0, inf)\n"
                             "  parameter H   = 1 [GPa]  in [0, inf)\n"
                             "  parameter rho = 7850 [kg/m^3]  in (0, inf)\n"
                             "  constant mu = E/(2*(1 + nu))\n"
                             "  state e on point = 0\n"
                             "  state p on point = @ 0\n"
                             "  trial = 2*mu*(dev(strain) - p)\n"
                             "  q = von_mises(trial)\n"
                             "%s"
                             "  p = p + 3/2*(e - previous(e))/max(q, 1 [Pa])*trial\n"
                             "  stress sigma = hooke(strain - p, E, nu)\n"
                             "end model\n";
  static const char *const ways[] = {"  e = e + max(q - f_y - H*e, 0)/(3*mu + H)\n",
                                     "  yield f = q - 3*mu*(e - previous(e)) - f_y - H*e\n"
                                     "  flow e along 1 returned when f >= 0\n"};
  (void)state;
  for (int k = 1; k < 3; k++) {
    double count[2];
    for (int w = 0; w < 2; w++) {
      char text[2000];
      snprintf(text, sizeof text, form, ways[w]);
      count[w] = operations_of(text, "deviator", settings[k]);
    }
    if (count[1] > count[0]) fail_msg("%g operations, not %g", count[1], count[0]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(deviators_are_tensors),
      cmocka_unit_test(derivatives_by_deviators_have_no_trace),
      cmocka_unit_test(zz_is_no_field),
      cmocka_unit_test(returns_cost_what_closed_forms_do),
      cmocka_unit_test(deviators_cost_less),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
