/* Every law of a continuum and of cracks beside the tests of kernels: its compiled kernel against
   the interpreter; Hooke's law against its closed form. Those of models/:
   test_points_of_cracking_match.c, test_points_of_concrete_match.c,
   test_points_of_models_match.c. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/kernel/points_kernel.h"

static void kernels_of_the_test_laws_match(void **state) {
  (void)state;
  check_folder(SOURCE_DIR "/tests/generator/laws/*.plm", check_law_of_points);
}

/* --- Hooke's law ------------------------------------------------------------------------------ */

enum { MOST = PL_MAX_STRAINS };
static const double E_0 = 30e9, NU = 0.23;

typedef struct answer {
  double stress[MOST], tangent[MOST][MOST], stored;
} answer;

/* A law of models/ with E and nu in its first two parameters, at one strain, in a setting. */
static answer ask(const char *name, law_setting setting, const double *strain) {
  char path[512], error[2000];
  const char *note;
  model m;
  snprintf(path, sizeof path, "%s/%s", SOURCE_DIR, name);
  assert_true(model_open(&m, path, NULL, 0));
  m.law = law_on_lattice(m.law, setting, false, 0);
  assert_true(model_plan(&m));
  const pl_law *kernel = model_kernel(&m, true, &note, error, sizeof error);
  assert_non_null(kernel);
  const int strains = PL_STRAINS(kernel->dimensions), stresses = PL_STRESSES(kernel->dimensions);
  double parameters[8], uniforms[64], size[PL_LANES] = {1}, in[MOST][PL_LANES] = {{0}},
                                      out[MOST][PL_LANES], tangent[MOST * MOST][PL_LANES],
                                      stored[PL_LANES];
  const double *from[MOST];
  double *to[MOST], *by[MOST * MOST], *observed[] = {stored};
  const pl_bond_class none = {.size = sizeof none};
  for (int k = 0; k < kernel->parameter_count; k++)
    parameters[k] = kernel->parameters[k].initial;
  parameters[0] = E_0;
  parameters[1] = NU;
  assert_true(kernel->uniform_count <= 64 && kernel->parameter_count <= 8);
  kernel->prepare(kernel, parameters, &none, uniforms);
  for (int k = 0; k < MOST; k++) {
    from[k] = in[k];
    to[k] = out[k];
    in[k][0] = k < strains ? strain[k] : 0;
  }
  for (int k = 0; k < MOST * MOST; k++)
    by[k] = tangent[k];
  const pl_points p = {.size = sizeof p,
                       .count = PL_LANES,
                       .strain = from,
                       .strain_rate = from,
                       .cell_size = size,
                       .stress = to,
                       .tangent = by,
                       .observed = observed};
  kernel->point_step(kernel, uniforms, &p);
  kernel->point_tangent(kernel, uniforms, &p);
  kernel->point_observe(kernel, uniforms, &p);
  answer a = {.stored = stored[0]};
  for (int k = 0; k < stresses; k++)
    a.stress[k] = out[k][0];
  for (int k = 0; k < strains; k++)
    for (int q = 0; q < strains; q++)
      a.tangent[k][q] = tangent[k * strains + q][0];
  assert_true(kernel->linear == (strstr(name, "/elastic.plm") != NULL));
  model_close(&m);
  return a;
}

static void is(double found, double wanted, double scale) {
  assert_true(fabs(found - wanted) <= 1e-12 * scale);
}

static void hooke_in_the_plane(void **state) {
  (void)state;
  const double e[3] = {1.3e-4, -0.7e-4, 0.4e-4}, mu = E_0 / (2 * (1 + NU)),
               lambda = E_0 * NU / ((1 + NU) * (1 - 2 * NU));
  for (int strain = 0; strain < 2; strain++) {
    const answer a =
        ask("models/elastic.plm", strain ? SETTING_PLANE_STRAIN : SETTING_PLANE_STRESS, e);
    const double l = strain ? lambda : 2 * mu * lambda / (lambda + 2 * mu), sum = e[0] + e[1];
    const double s[3] = {l * sum + 2 * mu * e[0], l * sum + 2 * mu * e[1], 2 * mu * e[2]};
    for (int k = 0; k < 3; k++)
      is(a.stress[k], s[k], E_0 * 1e-4);
    is(a.stress[3], strain ? lambda * sum : 0, E_0 * 1e-4);
    is(a.tangent[0][0], l + 2 * mu, E_0);
    is(a.tangent[0][1], l, E_0);
    is(a.tangent[1][0], l, E_0);
    is(a.tangent[2][2], mu, E_0);
    is(a.tangent[0][2], 0, E_0);
    is(a.stored, 0.5 * (s[0] * e[0] + s[1] * e[1] + 2 * s[2] * e[2]), E_0 * 1e-8);
  }
}

static void hooke_in_space(void **state) {
  (void)state;
  const double e[6] = {1e-4, -2e-4, 3e-4, 0.5e-4, -0.2e-4, 0.7e-4}, mu = E_0 / (2 * (1 + NU)),
               lambda = E_0 * NU / ((1 + NU) * (1 - 2 * NU)), sum = e[0] + e[1] + e[2];
  const answer a = ask("models/elastic.plm", SETTING_SPACE, e);
  double stored = 0;
  for (int k = 0; k < 6; k++) {
    const double s = 2 * mu * e[k] + (k < 3 ? lambda * sum : 0);
    is(a.stress[k], s, E_0 * 1e-4);
    is(a.tangent[k][k], k < 3 ? lambda + 2 * mu : mu, E_0);
    stored += 0.5 * s * e[k] * (k < 3 ? 1 : 2);
  }
  is(a.stored, stored, E_0 * 1e-8);
}

/* W = lambda/2 tr^2 + mu e:e (1 + c e:e/2): sigma = lambda tr 1 + 2 mu e (1 + c e:e). */
static void a_law_that_is_not_linear(void **state) {
  (void)state;
  const double e[6] = {1e-2, -2e-2, 1.5e-2, 0.5e-2, -0.2e-2, 0.7e-2}, c = 1000,
               mu = E_0 / (2 * (1 + NU)), lambda = E_0 * NU / ((1 + NU) * (1 - 2 * NU));
  const double square =
      e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + 2 * (e[3] * e[3] + e[4] * e[4] + e[5] * e[5]);
  const answer a = ask("models/stiffening.plm", SETTING_SPACE, e);
  for (int k = 0; k < 6; k++)
    is(a.stress[k], 2 * mu * e[k] * (1 + c * square) + (k < 3 ? lambda * (e[0] + e[1] + e[2]) : 0),
       E_0 * 1e-2);
  const double plane[3] = {4e-4, -1e-4, 2e-4};
  const answer p = ask("models/stiffening.plm", SETTING_PLANE_STRESS, plane);
  assert_true(p.stress[3] == 0);
  /* the strain along z that leaves no stress, by bisection */
  double low = -1e-3, high = 1e-3;
  for (int k = 0; k < 200; k++) {
    const double z = 0.5 * (low + high),
                 sq = plane[0] * plane[0] + plane[1] * plane[1] + z * z + 2 * plane[2] * plane[2];
    const double s = lambda * (plane[0] + plane[1] + z) + 2 * mu * z * (1 + c * sq);
    if (s > 0)
      high = z;
    else
      low = z;
  }
  const double sq = plane[0] * plane[0] + plane[1] * plane[1] + low * low + 2 * plane[2] * plane[2];
  is(p.stress[0], lambda * (plane[0] + plane[1] + low) + 2 * mu * plane[0] * (1 + c * sq),
     E_0 * 1e-3);
  is(p.stress[2], 2 * mu * plane[2] * (1 + c * sq), E_0 * 1e-3);
}

/* --- lefm ------------------------------------------------------------------------------------- */

/* Angles of largest hoop stress and what it amounts to, which the driven speed tells:
   v = (K_eq/K_Ic - 1) c_R. To the digits of the figures; with -K_II the same, mirrored. */
static void cracks_turn_to_the_largest_hoop_stress(void **state) {
  (void)state;
  static const double figures[][4] = {{1, 0.3, -29.103, 1.11867},
                                      {1, 1, -53.130, 1.78885},
                                      {0, 1, -70.529, 1.15470},
                                      {-0.5, 1, -80.266, 0.90686}};
  const law_choice driven = {"growth", "driven"};
  const pl_bond_class none = {.size = sizeof none};
  model m;
  const pl_law *kernel = open_kernel(&m, SOURCE_DIR "/models/lefm.plm", &driven);
  double in[PL_TIP_INPUTS][PL_LANES] = {{0}}, out[PL_TIP_RESULTS][PL_LANES], uniforms[64];
  const double v_max = 0.99999, c_R = 2000;
  const double *from[PL_TIP_INPUTS];
  double *to[PL_TIP_RESULTS];
  assert_true(kernel->parameter_count == 3 && kernel->uniform_count <= 64);
  assert_int_equal(kernel->field_count + kernel->output_count, 0);
  for (int k = 0; k < PL_TIP_INPUTS; k++)
    from[k] = in[k];
  for (int k = 0; k < PL_TIP_RESULTS; k++)
    to[k] = out[k];
  const pl_tips tips = {.size = sizeof tips, .count = PL_LANES, .in = from, .out = to};
  for (size_t k = 0; k < sizeof figures / sizeof *figures; k++)
    for (int mirrored = 0; mirrored < 2; mirrored++) {
      const double K_eq = figures[k][3],
                   toughness[] = {0.6 * K_eq, 150, v_max} /* K_Ic, v_0, v_max */;
      kernel->prepare(kernel, toughness, &none, uniforms);
      in[PL_TIP_K_I][0] = figures[k][0];
      in[PL_TIP_K_II][0] = (mirrored ? -1 : 1) * figures[k][1];
      in[PL_TIP_RAYLEIGH_SPEED][0] = c_R;
      kernel->tip_look(kernel, uniforms, &tips);
      const double degrees = out[PL_TIP_TOWARD][0] * 180 / M_PI * (mirrored ? -1 : 1);
      assert_true(out[PL_TIP_GROW][0] == 1);
      assert_true(fabs(degrees - figures[k][2]) < 0.5e-3);
      assert_true(fabs((out[PL_TIP_RUN][0] / c_R + 1) * 0.6 * K_eq - K_eq) < 0.6e-5);
      const double tougher[] = {K_eq * 1.00001, 150, v_max};
      kernel->prepare(kernel, tougher, &none, uniforms);
      kernel->tip_look(kernel, uniforms, &tips);
      assert_true(out[PL_TIP_GROW][0] == 0);
    }
  model_close(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(kernels_of_the_test_laws_match), cmocka_unit_test(hooke_in_the_plane),
      cmocka_unit_test(hooke_in_space), cmocka_unit_test(a_law_that_is_not_linear),
      cmocka_unit_test(cracks_turn_to_the_largest_hoop_stress)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
