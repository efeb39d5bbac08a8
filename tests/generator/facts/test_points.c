/* Laws of continua: moduli and speeds of waves that they imply, against the figures of three
   materials; which are linear, found and not declared; slopes of what is made of tensors, against
   differences of the stress; components and derivatives by tensors. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dsl/semantics/law_variant.h"
#include "generator/facts/point_facts.h"
#include "tests/generator/law_text.h"

enum { MOST = PL_MAX_STRAINS };

static const char head[] = "model tested\n  law continuum\n"
                           "  for plane_stress, plane_strain, space%s\n"
                           "  parameter E   = 2 [GPa]        in (0, inf)\n"
                           "  parameter nu  = 0.2            in [0, 0.5)\n"
                           "  parameter c   = %s             in [0, inf)\n"
                           "  parameter rho = 2400 [kg/m^3]  in (0, inf)\n"
                           "  constant mu     = E/(2*(1 + nu))\n"
                           "  constant lambda = E*nu/((1 + nu)*(1 - 2*nu))\n"
                           "  constant I      = tensor(1, 1, 1, 0)\n";

static tested_law *open_body(const char *body, const char *c, const law_choice *choice) {
  char text[4000];
  int n = snprintf(text, sizeof text, head, ", anisotropic", c);
  snprintf(text + n, sizeof text - (size_t)n, "%s\nend model\n", body);
  tested_law *t = open_law_chosen(text, choice, choice ? 1 : 0);
  if (!t->plan) fail_msg("%s cannot be compiled", body);
  return t;
}

/* --- what a law implies ----------------------------------------------------------------------- */

/* Concrete and steel in plane stress and strain: c_d, c_s, c_R in m/s. */
static void speeds_of_waves(void **state) {
  (void)state;
  static const struct {
    double E, nu, rho, c_d[2], c_s, c_R[2];
  } all[] = {{31.37e9, 0.2, 2400, {3690, 3811}, 2334, {2112, 2126}},
             {30e9, 0.2, 2400, {3608, 3727}, 2282, {2066, 2079}},
             {190e9, 0.3, 8000, {5109, 5654}, 3022, {2769, 2803}}};
  tested_law *t = open_law_file(SOURCE_DIR "/models/elastic.plm");
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
    const double values[] = {all[k].E, all[k].nu, all[k].rho};
    point_facts found[POINT_SETTINGS];
    assert_int_equal(point_facts_of(t->law, values, found), 3);
    for (int s = 0; s < 3; s++) {
      const int as = s > 0; /* waves in space are those of plane strain */
      assert_true(found[s].linear && found[s].isotropic && found[s].has_mass);
      assert_true(fabs(found[s].E - all[k].E) < 1e-12 * all[k].E);
      assert_true(fabs(found[s].nu - all[k].nu) < 1e-12);
      assert_true(fabs(found[s].c_d - all[k].c_d[as]) < 0.5);
      assert_true(fabs(found[s].c_s - all[k].c_s) < 0.5);
      assert_true(fabs(found[s].c_R - all[k].c_R[as]) < 0.5);
    }
  }
  close_law(t);
}

static void what_knows_the_axes_has_no_moduli(void **state) {
  (void)state;
  tested_law *t = open_body("  energy W = mu*(strain : strain) + c*E*strain[x,x]**2", "1", NULL);
  const double values[] = {2e9, 0.2, 1, 2400}, none[] = {2e9, 0.2, 0, 2400};
  point_facts found[POINT_SETTINGS];
  assert_int_equal(point_facts_of(t->law, values, found), 3);
  for (int s = 0; s < 3; s++)
    assert_true(found[s].linear && !found[s].isotropic);
  point_facts_of(t->law, none, found);
  for (int s = 0; s < 3; s++)
    assert_true(found[s].isotropic && fabs(found[s].nu) < 1e-12);
  close_law(t);
}

/* --- linear ----------------------------------------------------------------------------------- */

static bool is_linear(tested_law *t, law_setting setting) {
  kernel_plan *plan = plan_kernel(law_on_lattice(t->law, setting, false, 0), &t->said);
  assert_non_null(plan);
  const bool linear = plan->linear;
  plan_free(plan);
  return linear;
}

static void linear_laws_are_found(void **state) {
  (void)state;
  static const struct {
    const char *body, *c;
    bool linear;
  } all[] = {
      {"  stress sigma = hooke(strain, E, nu)", "1", true},
      {"  stress sigma = lambda*trace(strain)*I + 2*mu*strain", "1", true},
      {"  e = strain\n  sum = e[x,x] + e[y,y] + e[z,z]\n"
       "  stress sigma = tensor(lambda*sum + 2*mu*e[x,x], lambda*sum + 2*mu*e[y,y], "
       "lambda*sum + 2*mu*e[z,z], 2*mu*e[x,y], 2*mu*e[y,z], 2*mu*e[z,x])",
       "1", true},
      {"  stress sigma = 3*(lambda + 2/3*mu)*(strain - dev(strain)) + 2*mu*dev(strain)", "1", true},
      {"  energy W = lambda/2*trace(strain)**2 + mu*(strain : strain)", "1", true},
      {"  energy W = lambda/2*trace(strain)**2 + mu*(dev(strain) : dev(strain))", "1", true},
      /* a branch that options decide, and one that no strain does */
      {"  option form = plain | bent\n"
       "  stress sigma = | 2*mu*strain*(1 + norm(strain)) when form == bent\n"
       "                 | 2*mu*strain otherwise",
       "1", true},
      {"  stress sigma = | 2*mu*strain when plane_strain or space or plane_stress\n"
       "                 | 2*mu*strain*(1 + norm(strain)) otherwise",
       "1", true},
      {"  stress sigma = | 2*mu*strain when c > 0\n | 3*mu*strain otherwise", "1", true},
      /* not linear, if only a little, or with another value of a parameter */
      {"  energy W = mu*(strain : strain)*(1 + 1e-12*(strain : strain))", "1", false},
      {"  energy W = mu*(strain : strain)*(1 + c*(strain : strain))", "0", false},
      {"  stress sigma = | 2*mu*strain when trace(strain) > 0\n | 3*mu*strain otherwise", "1",
       false},
      /* neither sizes, rates, states nor a stress at rest */
      {"  stress sigma = 2*mu*strain*(1 + h/1 [m])", "1", false},
      {"  stress sigma = 2*mu*(strain + 1 [us]*strain_rate)", "1", false},
      {"  state e on point = tensor 0\n  e = strain\n  stress sigma = 2*mu*strain", "1", false},
      {"  stress sigma = 2*mu*strain + E*1e-6*I", "1", false},
  };
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
    tested_law *t = open_body(all[k].body, all[k].c, NULL);
    for (law_setting s = SETTING_PLANE_STRESS; s <= SETTING_SPACE; s++)
      if (is_linear(t, s) != all[k].linear)
        fail_msg("in %s this is %slinear:\n%s", law_setting_name(s), all[k].linear ? "" : "not ",
                 all[k].body);
    close_law(t);
  }
  const law_choice bent = {"form", "bent"};
  tested_law *t = open_body(all[6].body, "1", &bent);
  assert_false(t->plan->linear);
  close_law(t);
}

/* --- slopes ----------------------------------------------------------------------------------- */

typedef struct asked {
  double stress[MOST], tangent[MOST][MOST], observed[8];
} asked;

static void ask(const kernel_plan *plan, const double *parameters, const double *strain, asked *a) {
  pl_law *kernel = plan_interpreted(plan);
  const int strains = PL_STRAINS(kernel->dimensions);
  double uniforms[256], in[MOST][PL_LANES] = {{0}}, out[MOST][PL_LANES] = {{0}},
                        tangent[MOST * MOST][PL_LANES], size[PL_LANES] = {0},
                        seen[8][PL_LANES] = {{0}}, none[8][PL_LANES] = {{0}};
  const double *from[MOST], *old[8];
  double *to[MOST], *by[MOST * MOST], *observed[8], *new_field[8];
  const pl_bond_class bond = {.size = sizeof bond};
  assert_true(kernel->uniform_count <= 256 && kernel->output_count < 8 && kernel->field_count <= 8);
  kernel->prepare(kernel, parameters, &bond, uniforms);
  for (int k = 0; k < MOST; k++) {
    from[k] = in[k];
    to[k] = out[k];
    in[k][0] = k < strains ? strain[k] : 0;
  }
  for (int k = 0; k < MOST * MOST; k++)
    by[k] = tangent[k];
  for (int k = 0; k < 8; k++) {
    observed[k] = seen[k];
    old[k] = none[k];
    new_field[k] = none[k];
  }
  const pl_points p = {.size = sizeof p,
                       .count = PL_LANES,
                       .strain = from,
                       .strain_rate = from,
                       .cell_size = size,
                       .old_field = old,
                       .new_field = new_field,
                       .stress = to,
                       .tangent = by,
                       .observed = observed};
  kernel->point_observe(kernel, uniforms, &p);
  kernel->point_tangent(kernel, uniforms, &p);
  kernel->point_step(kernel, uniforms, &p);
  for (int k = 0; k < strains; k++) {
    a->stress[k] = out[k][0];
    for (int q = 0; q < strains; q++)
      a->tangent[k][q] = tangent[k * strains + q][0];
  }
  for (int k = 0; k < 8; k++)
    a->observed[k] = seen[k][0];
  plan_interpreted_free(kernel);
}

static const double strain_of_test[MOST] = {3e-3, -2e-3, 1.2e-3, 0.9e-3, -0.4e-3, 0.7e-3};

/* Central differences of a strain of 1e-6; shears stand twice in it. */
static void check_slopes(const kernel_plan *plan, const double *parameters, const char *body) {
  const int strains = PL_STRAINS(plan->dimensions), normals = plan->dimensions;
  const double by = 1e-7;
  asked here, up, down;
  double moved[MOST], most = 0;
  ask(plan, parameters, strain_of_test, &here);
  for (int k = 0; k < strains; k++)
    for (int q = 0; q < strains; q++)
      most = fmax(most, fabs(here.tangent[k][q]));
  assert_true(most > 0);
  for (int q = 0; q < strains; q++) {
    memcpy(moved, strain_of_test, sizeof moved);
    moved[q] += by;
    ask(plan, parameters, moved, &up);
    moved[q] -= 2 * by;
    ask(plan, parameters, moved, &down);
    for (int k = 0; k < strains; k++) {
      const double slope = (up.stress[k] - down.stress[k]) / (2 * by) / (q < normals ? 1 : 2);
      if (!(fabs(slope - here.tangent[k][q]) < 1e-6 * most))
        fail_msg("%s\nD[%d][%d] is %g, not %g", body, k, q, here.tangent[k][q], slope);
    }
  }
}

static void slopes_of_tensors(void **state) {
  (void)state;
  static const char *const sizes[] = {"trace(strain)",
                                      "norm(strain)",
                                      "norm(dev(strain))",
                                      "strain : dev(strain)",
                                      "J2(strain)",
                                      "von_mises(strain)",
                                      "principal(strain, 1)",
                                      "principal(strain, 2)",
                                      "principal(strain, 3)",
                                      "positive_part(trace(strain))",
                                      "max(strain[x,x], strain[x,y], 0)",
                                      "exp(-norm(strain))",
                                      "sqrt(strain : strain)",
                                      "strain[x,x]*strain[y,y] - strain[x,y]**2",
                                      "(| norm(strain) when trace(strain) > 0 | 2 otherwise)",
                                      "trace(diff(strain : strain, strain))"};
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
    char body[500];
    snprintf(body, sizeof body, "  stress sigma = mu*(%s)*(strain + 0.001*I) + E*strain", sizes[k]);
    tested_law *t = open_body(body, "1", NULL);
    for (law_setting s = SETTING_PLANE_STRESS; s <= SETTING_SPACE; s++) {
      kernel_plan *plan = plan_kernel(law_on_lattice(t->law, s, false, 0), &t->said);
      check_slopes(plan, t->parameters, body);
      plan_free(plan);
    }
    close_law(t);
  }
}

/* dW/dstrain is the stress, components on either side of the diagonal being one. */
static void derivatives_by_tensors(void **state) {
  (void)state;
  tested_law *t = open_body("  W_0 = lambda/2*trace(strain)**2 + mu*norm(strain)**2*(1 + "
                            "c*norm(strain)**2)\n"
                            "  stress sigma = diff(W_0, strain)\n"
                            "  gap = sigma - (lambda*trace(strain)*I + 2*mu*strain*(1 + "
                            "2*c*norm(strain)**2))\n"
                            "  output error = norm(gap)/E\n"
                            "  output xy = sigma[x,y]\n  output yx = sigma[y,x]",
                            "1000", NULL);
  for (law_setting s = SETTING_PLANE_STRAIN; s <= SETTING_SPACE; s++) {
    kernel_plan *plan = plan_kernel(law_on_lattice(t->law, s, false, 0), &t->said);
    asked a;
    ask(plan, t->parameters, strain_of_test, &a);
    assert_true(a.observed[1] < 1e-17);
    assert_true(a.observed[2] != 0 && a.observed[2] == a.observed[3]);
    assert_true(a.observed[2] == a.stress[s == SETTING_SPACE ? 3 : 2]);
    plan_free(plan);
  }
  close_law(t);
}

/* 0 in one line of cases, a tensor in the other. */
static void a_tensor_or_nothing(void **state) {
  (void)state;
  tested_law *t = open_body("  nonconservative \"cut\"\n"
                            "  stress sigma = | 0            when trace(strain) < 0\n"
                            "                 | 2*mu*strain  otherwise",
                            "1", NULL);
  kernel_plan *plan = plan_kernel(law_on_lattice(t->law, SETTING_SPACE, false, 0), &t->said);
  const double mu = 2e9 / 2.4, pressed[MOST] = {-1e-3, 0, 0, 1e-3, 0, 0};
  asked a;
  ask(plan, t->parameters, strain_of_test, &a);
  for (int k = 0; k < MOST; k++)
    assert_true(fabs(a.stress[k] - 2 * mu * strain_of_test[k]) < 1e-6);
  ask(plan, t->parameters, pressed, &a);
  for (int k = 0; k < MOST; k++)
    assert_true(a.stress[k] == 0);
  plan_free(plan);
  close_law(t);
}

/* A tensor's components are fields of their own, in one row, and 0 out of the plane. */
static void states_that_are_tensors(void **state) {
  (void)state;
  static const char *const names[] = {"w", "e_xx", "e_yy", "e_zz", "e_xy", "e_yz", "e_xz"};
  tested_law *t = open_body("  state w on point = 1\n  state e on point = tensor 0\n"
                            "  e = e + strain/2\n  w = w + norm(e)\n"
                            "  stress sigma = 2*mu*(strain + e)*w\n"
                            "  energy W = mu*w*((strain + e):(strain + e))\n  output now = e[x,y]",
                            "1", NULL);
  assert_int_equal(t->kernel->field_count, 7);
  for (int k = 0; k < 7; k++) {
    assert_string_equal(t->kernel->fields[k].name, names[k]);
    assert_string_equal(t->kernel->fields[k].unit, "1");
    assert_true(t->kernel->fields[k].initial == (k == 0));
  }
  close_law(t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(speeds_of_waves),
      cmocka_unit_test(what_knows_the_axes_has_no_moduli),
      cmocka_unit_test(linear_laws_are_found),
      cmocka_unit_test(slopes_of_tensors),
      cmocka_unit_test(derivatives_by_tensors),
      cmocka_unit_test(a_tensor_or_nothing),
      cmocka_unit_test(states_that_are_tensors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
