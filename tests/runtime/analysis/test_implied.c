/* What a law implies, against closed forms: stiffness, strength, work of fracture and waves of the
   shipped laws on the hexagonal lattice. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "generator/kernel/model.h"
#include "runtime/analysis/implied.h"

enum { MOST_PARAMETERS = 40 };

typedef struct probe {
  model model;
  const pl_law *law;
  double parameters[MOST_PARAMETERS];
  rows *lattice;
} probe;

static void set(probe *p, const char *name, double value) {
  for (int k = 0; k < p->law->parameter_count; k++)
    if (strcmp(p->law->parameters[k].name, name) == 0) {
      p->parameters[k] = value;
      return;
    }
  fail_msg("no parameter %s", name);
}

static double get(const probe *p, const char *name) {
  for (int k = 0; k < p->law->parameter_count; k++)
    if (strcmp(p->law->parameters[k].name, name) == 0) return p->parameters[k];
  fail_msg("no parameter %s", name);
  return NAN;
}

static void open_law(probe *p, const char *name, const law_choice *choices, int count,
                     double spacing) {
  char path[512];
  snprintf(path, sizeof path, "%s/models/%s.plm", SOURCE_DIR, name);
  bool good = model_open(&p->model, path, choices, count) && model_plan(&p->model);
  if (!good) diag_print(&p->model.said, stderr);
  assert_true(good);
  char error[256];
  const char *note;
  p->law = model_kernel(&p->model, true, &note, error, sizeof error);
  assert_true(p->law->parameter_count <= MOST_PARAMETERS);
  for (int k = 0; k < p->law->parameter_count; k++)
    p->parameters[k] = p->law->parameters[k].initial;
  p->lattice = implied_lattice(spacing, 0.1524, get(p, "rho"));
  assert_non_null(p->lattice);
}

static void close_law(probe *p) {
  rows_free(p->lattice);
  model_close(&p->model);
}

static void near(double value, double expected, double relative) {
  if (!(fabs(value - expected) <= relative * fabs(expected)))
    fail_msg("%.12g is not %.12g (relative difference %.3g, allowed %.3g)", value, expected,
             value / expected - 1, relative);
}

/* g = (alpha2 - alpha1 + alpha1 alpha3)/2 EA S_t^2 s: the area under two straight lines. */
static void bilinear_work_of_fracture(void **state) {
  (void)state;
  static const double cases[3][3] = {
      {3.175e-3, 1.5e-4, 65.919}, {6.35e-3, 1.18e-4, 81.587}, {12.7e-3, 8.0e-5, 75.001}};
  for (int k = 0; k < 3; k++) {
    probe p;
    implied_bond b;
    double s = cases[k][0], S_t = cases[k][1], t = 0.1524;
    open_law(&p, "mplm_bilinear", NULL, 0, s);
    set(&p, "S_t", S_t);
    implied_bond_curve(p.law, p.parameters, p.lattice, 0, &b);
    double EA = 30e9 * s * t / (sqrt(3) * (1 - 0.2));
    double energy = (20 - 0.13 + 0.13 * 415) / 2 * EA * S_t * S_t * s;
    assert_true(b.separates);
    near(b.energy, energy, 2e-6);
    near(b.row_energy, energy / (sqrt(3) / 2 * s * t), 2e-6);
    near(b.row_energy, cases[k][2], 1e-5);
    near(b.peak_force, EA * S_t, 1e-6);
    near(b.stretch_at_peak, S_t, 1e-6);
    close_law(&p);
  }
}

/* A bond has half of G_f s t, whatever the spacing and the shape of the curve. */
static void cohesive_work_of_fracture(void **state) {
  (void)state;
  const law_choice exponential = {"softening", "exponential"};
  for (int k = 0; k < 4; k++) {
    probe p;
    implied_bond b;
    double s = k & 1 ? 10e-3 : 2.5e-3;
    open_law(&p, "cohesive", &exponential, k & 2 ? 1 : 0, s);
    implied_bond_curve(p.law, p.parameters, p.lattice, 0, &b);
    assert_true(b.separates);
    near(b.energy, 80.0 * s * 0.1524 / 2, 2e-6);
    near(b.peak_force, sqrt(3) / 2 * 3e6 * s * 0.1524, 1e-6);
    near(b.stretch_at_peak, 1e-4, 1e-6);
    close_law(&p);
  }
}

/* alpha EA eps_t^2/(sqrt(3) t): 33 N/m with alpha_t = 10 at 20 mm; with tension = energy G_F at any
   spacing. */
static void linear_work_of_fracture(void **state) {
  (void)state;
  const law_choice energy = {"tension", "energy"};
  for (int k = 0; k < 3; k++) {
    probe p;
    implied_bond b;
    double s = k == 2 ? 10e-3 : 20e-3, eps_t = 1.26e-4;
    open_law(&p, "mplm_concrete", &energy, k > 0, s);
    implied_bond_curve(p.law, p.parameters, p.lattice, 0, &b);
    assert_true(b.separates);
    near(b.row_energy, k > 0 ? 175 : 10 * 24.86e9 * s * eps_t * eps_t / (3 * (1 - 0.2)), 2e-6);
    near(b.peak_force, 24.86e9 * s * 0.1524 / (sqrt(3) * 0.8) * eps_t, 1e-6);
    close_law(&p);
  }
}

/* Where the stiffness falls along a line the force rises beyond eps_t, and the ratio of G_F is
   another: alpha^2 + alpha + 1 = 3 times the one above. */
static void work_of_fracture_where_stiffness_falls(void **state) {
  (void)state;
  const law_choice choices[] = {{"softening", "strain"}, {"tension", "energy"}};
  for (int k = 0; k < 2; k++) {
    probe p;
    implied_bond b;
    const double s = 20e-3, eps_t = 1.26e-4;
    const double ratio = 3 * (1 - 0.2) * 175 / (24.86e9 * s * eps_t * eps_t);
    const double alpha = k ? (sqrt(12 * ratio - 3) - 1) / 2 : 10;
    open_law(&p, "mplm_concrete", choices, 1 + k, s);
    implied_bond_curve(p.law, p.parameters, p.lattice, 0, &b);
    assert_true(b.separates);
    near(b.row_energy, k ? 175 : 37 * 24.86e9 * s * eps_t * eps_t / (3 * (1 - 0.2)), 2e-6);
    near(b.stretch_at_peak, alpha * eps_t / 2, 1e-3);
    near(b.peak_force,
         24.86e9 * s * 0.1524 / (sqrt(3) * 0.8) * eps_t * alpha * alpha / (4 * (alpha - 1)), 1e-6);
    close_law(&p);
  }
}

/* A crack along the rows cuts two bonds a spacing, one across them a row bond and an inclined one a
   row height. Each costs g whatever way its ends go apart: bonds without bending, of both laws. */
static void cracks_cost_all_bonds_that_they_cut(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    probe p;
    implied_bond b;
    double s = 5e-3, t = 0.1524;
    open_law(&p, k ? "mplm_bilinear" : "cohesive", NULL, 0, s);
    if (k) set(&p, "nu", 1.0 / 3), set(&p, "beta", 0);
    implied_bond_curve(p.law, p.parameters, p.lattice, 0, &b);
    near(implied_crack_energy(p.law, p.parameters, p.lattice, 0),
         2 * b.energy / (sqrt(3) / 2 * s * t), 2e-6);
    near(implied_crack_energy(p.law, p.parameters, p.lattice, 1), 2 * b.energy / (s * t), 2e-6);
    close_law(&p);
  }
}

/* Curvature breaks an inclined bond of mplm_bilinear before its stretch would: the crack along the
   rows, by Simpson's rule over the law's equations. */
static void bending_breaks_inclined_bonds_early(void **state) {
  (void)state;
  enum { STEPS = 400000 };
  probe p;
  double s = 6.35e-3, t = 0.1524, S_t = 1.18e-4;
  open_law(&p, "mplm_bilinear", NULL, 0, s);
  double EA = 30e9 * s * t / (sqrt(3) * 0.8),
         EI = 30e9 * s * s * s * t * 0.4 / (12 * sqrt(3) * 0.96);
  double work = 0, end = 415 * S_t;
  for (int k = 0; k <= STEPS; k++) {
    double way = end * k / STEPS, x = 0.5, y = 0.5 * sqrt(3) + way;
    double length = hypot(x, y), stretch = length - 1, turn = atan2(y, x) - acos(0.5);
    double e = stretch + 0.1 * 6 * turn;
    double whole = e <= S_t        ? 1
                   : e <= 20 * S_t ? 1 - (20 - 0.13) / 19 * (e - S_t) / e
                   : e < end       ? 0.13 / 395 * (end - e) / e
                                   : 0;
    double pull =
        whole * (EA * stretch * s * y / length + 12 * EI / s * turn * x / (length * length));
    work += (k == 0 || k == STEPS ? 1 : k % 2 ? 4 : 2) / 3.0 * pull * end / STEPS;
  }
  near(implied_crack_energy(p.law, p.parameters, p.lattice, 1), 2 * work / (s * t), 1e-5);
  close_law(&p);
}

static void an_elastic_bond_never_separates(void **state) {
  (void)state;
  probe p;
  implied_bond b;
  open_law(&p, "elastic_central", NULL, 0, 5e-3);
  implied_bond_curve(p.law, p.parameters, p.lattice, 0, &b);
  assert_false(b.separates);
  assert_true(isinf(b.energy) && isinf(b.peak_force) && isnan(b.stretch_at_peak));
  assert_true(isinf(implied_crack_energy(p.law, p.parameters, p.lattice, 0)));
  close_law(&p);
}

/* Plane stress: c_L^2 = E/(rho (1 - nu^2)), c_T^2 = E/(2 rho (1 + nu)); all particles turning
   together against their bonds: omega^2 = 20 (1 - 3 nu)/(1 - nu^2) (c/s)^2 with I = (2/5) m
   (s/2)^2. */
static void waves_and_constants(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    probe p;
    implied_elasticity e;
    implied_waves c;
    double nu = 0.1 * k, E = 30e9, rho = 2323, s = 6.35e-3;
    open_law(&p, k == 2 ? "mplm_bilinear" : "elastic_micropolar", NULL, 0, s);
    set(&p, "nu", nu);
    assert_true(implied_elastic(p.law, p.parameters, p.lattice, &e));
    implied_wave_speeds(p.law, p.parameters, p.lattice, &e, &c);
    for (int d = 0; d < 2; d++) {
      near(e.E[d], E, 1e-12);
      assert_true(fabs(e.nu[d] - nu) < 1e-12);
      near(c.longitudinal[d], sqrt(E / (rho * (1 - nu * nu))), 1e-12);
    }
    near(c.transverse, sqrt(E / (2 * rho * (1 + nu))), 1e-12);
    near(c.rotation_cutoff, sqrt(20 * (1 - 3 * nu) / (1 - nu * nu) * E / rho) / s, 1e-9);
    close_law(&p);
  }
}

/* Laws written with the size of a rotation, or with tension and compression by themselves, have no
   derivative of their force at rest; the lattice has its E and nu all the same. */
static void kinks_at_rest_do_not_count(void **state) {
  (void)state;
  static const char *const names[] = {"../examples/course/03_moments/teacher/equal/square",
                                      "../examples/course/05_memory/teacher/equal/energy"};
  for (int k = 0; k < 2; k++) {
    probe p;
    implied_elasticity e;
    open_law(&p, names[k], NULL, 0, 10e-3);
    assert_true(implied_elastic(p.law, p.parameters, p.lattice, &e));
    for (int d = 0; d < 2; d++) {
      near(e.E[d], 30e9, 1e-9);
      near(e.nu[d], k == 0 ? 0.2 : 1.0 / 3, 1e-9);
    }
    close_law(&p);
  }
}

/* Of the stress under uniform strain e along x, the row bonds give E e and the inclined ones,
   stretched e/4, E e/8. The row bonds soften so slowly that the stress is largest where the
   inclined ones reach S_t, at e = 4 S_t. Along y the inclined bonds alone work, stretched 3/4 e:
   9/8 E e until 4/3 S_t. */
static void strength_along_the_rows(void **state) {
  (void)state;
  probe p;
  double at;
  open_law(&p, "cohesive", NULL, 0, 5e-3);
  double strength = implied_strength(p.law, p.parameters, p.lattice, 0, &at);
  near(at, 4e-4, 1e-3);
  double s = 5e-3, w_1 = 2 * 80 / (sqrt(3) * 3e6), left = (w_1 - 4e-4 * s) / (w_1 - 1e-4 * s);
  near(strength, 30e9 * (1e-4 * left + 4e-4 / 8), 1e-3);
  strength = implied_strength(p.law, p.parameters, p.lattice, 1, &at);
  near(at, 1e-4 / 0.75, 1e-3);
  near(strength, 9.0 / 8 * 30e9 * 1e-4 / 0.75, 1e-3);
  close_law(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bilinear_work_of_fracture),
      cmocka_unit_test(cohesive_work_of_fracture),
      cmocka_unit_test(linear_work_of_fracture),
      cmocka_unit_test(work_of_fracture_where_stiffness_falls),
      cmocka_unit_test(cracks_cost_all_bonds_that_they_cut),
      cmocka_unit_test(bending_breaks_inclined_bonds_early),
      cmocka_unit_test(an_elastic_bond_never_separates),
      cmocka_unit_test(waves_and_constants),
      cmocka_unit_test(kinks_at_rest_do_not_count),
      cmocka_unit_test(strength_along_the_rows),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
