/* A composite of fibres, models/pmb_fibre.plm: elastic constants over the angle of the fibres
   against the lattice's own sum over its bonds and against the solid with bonds in all directions;
   bonds that break by their angle. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/analysis/patch.h"
#include "runtime/analysis/stencil.h"
#include "tests/verification/case.h"

typedef struct composite {
  law_case c;
  deck_case k;
  double D[36];
} composite;

static const char *const lattices[] = {
    "kind = 'hexagonal'",
    "kind = 'hexagonal' rotation = 17",
    "kind = 'hexagonal' horizon = 3.015",
    "kind = 'square' horizon = 3.015 rotation = 20",
    "kind = 'hexagonal' horizon = 4.015 rotation = 5",
};
enum { LATTICES = sizeof lattices / sizeof *lattices };
static const char *const space_lattice = "kind = 'fcc' shells = 2";

static double degrees(double angle) {
  return angle * acos(-1) / 180;
}

static void composite_open(composite *m, const char *named, law_setting setting,
                           const char *lattice) {
  char text[1024];
  const bool space = setting == SETTING_SPACE;
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n&lattice name = 'l' %s spacing = '7 mm' %s%s%s /\n"
           "&body lattice = 'l' %s /\n&material lattice = 'l' model = 'x' /\n",
           lattice, space ? "" : "thickness = '30 mm' setting = '",
           space ? "" : law_setting_name(setting), space ? "" : "'",
           space ? "shape = 'box' corner = 0, 0, 0 size = '40 mm', '40 mm', '40 mm'"
                 : "shape = 'disc' centre = 0, 0 radius = '40 mm'");
  assert_true(deck_case_lattice(&m->k, text));
  assert_true(law_case_open_in(&m->c, named, setting));
  m->k.lattice->mass = *law_case_value(&m->c, "rho") * m->k.lattice->volume;
}

static void composite_close(composite *m) {
  law_case_close(&m->c);
  deck_case_close(&m->k);
}

static void set_fibre(composite *m, double x, double y, double z) {
  *law_case_value(&m->c, "fibre_x") = x;
  *law_case_value(&m->c, "fibre_y") = y;
  *law_case_value(&m->c, "fibre_z") = z;
}

/* Of long waves, with the law's own kernel. */
static void measure(composite *m) {
  stencil s = stencil_new(m->c.compiled, m->c.parameters, m->k.lattice);
  stencil_elastic(&s, m->k.lattice, m->D);
  stencil_free(&s);
}

/* E of a bond at an angle to the fibres. */
static double bond_modulus(composite *m, const double *n, const double *e) {
  const double E_1 = *law_case_value(&m->c, "E_1"), E_2 = *law_case_value(&m->c, "E_2");
  const double c = n[0] * e[0] + n[1] * e[1] + n[2] * e[2];
  return E_2 + (E_1 - E_2) * pow(c, 8);
}

/* D = k/2 sum(E n n n n s V)/sum(s V) over the bonds of a particle, k = 6, 6.4 or 12: the second
   derivative of the energy density sum(c s V S^2)/4 with c = k E/sum(s V), S = n.eps.n. */
static void sum_over_bonds(composite *m, law_setting setting, const double *e, double *D) {
  static const int first[2][6] = {{0, 1, 0}, {0, 1, 2, 0, 1, 0}},
                   second[2][6] = {{0, 1, 1}, {0, 1, 2, 1, 2, 2}};
  const rows *w = m->k.lattice;
  const int space = w->dimensions == 3, size = space ? 6 : 3;
  const double k = space ? 12 : setting == SETTING_PLANE_STRESS ? 6 : 6.4;
  double length = 0;
  memset(D, 0, 36 * sizeof *D);
  for (int b = 0; b < w->directions; b++) {
    const pl_bond_class bond = rows_bond_class(w, b);
    const double n[3] = {bond.chord[0] / bond.s, bond.chord[1] / bond.s, bond.chord[2] / bond.s};
    length += bond.s;
    for (int r = 0; r < size; r++)
      for (int c = 0; c < size; c++)
        D[r * size + c] += 0.5 * k * bond_modulus(m, n, e) * bond.s * n[first[space][r]] *
                           n[second[space][r]] * n[first[space][c]] * n[second[space][c]];
  }
  for (int q = 0; q < size * size; q++)
    D[q] /= length;
}

static double error_of_D(const composite *m, const double *exact) {
  const int size = m->k.lattice->dimensions == 3 ? 6 : 3;
  double worst = 0, largest = 0;
  for (int q = 0; q < size * size; q++) {
    worst = fmax(worst, fabs(m->D[q] - exact[q]));
    largest = fmax(largest, fabs(exact[q]));
  }
  return worst / largest;
}

/* --- the lattice's own sum -------------------------------------------------------------------- */

static void stiffness_is_the_sum_over_the_bonds(void **state) {
  (void)state;
  double worst = 0;
  for (int setting = SETTING_PLANE_STRESS; setting <= SETTING_PLANE_STRAIN; setting++)
    for (int k = 0; k < LATTICES; k++) {
      composite m;
      double exact[36];
      composite_open(&m, "pmb_fibre", (law_setting)setting, lattices[k]);
      for (double angle = 0; angle < 180; angle += 7.5) {
        const double e[3] = {cos(degrees(angle)), sin(degrees(angle)), 0};
        set_fibre(&m, 3 * e[0], 3 * e[1], 0); /* of any length */
        measure(&m);
        sum_over_bonds(&m, (law_setting)setting, e, exact);
        const double error = error_of_D(&m, exact);
        if (!(error < 1e-13)) fail_msg("%s at %g: D is off by %.3g", lattices[k], angle, error);
        worst = fmax(worst, error);
      }
      composite_close(&m);
    }
  print_message("largest error of D: %.2g\n", worst);
}

static void stiffness_in_space_is_the_sum_over_the_bonds(void **state) {
  (void)state;
  static const double fibres[][3] = {{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, -2, 3}, {0, 0, -5}};
  composite m;
  double exact[36];
  composite_open(&m, "pmb_fibre", SETTING_SPACE, space_lattice);
  for (size_t k = 0; k < sizeof fibres / sizeof *fibres; k++) {
    const double *f = fibres[k], length = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    set_fibre(&m, f[0], f[1], f[2]);
    measure(&m);
    sum_over_bonds(&m, SETTING_SPACE, (double[]){f[0] / length, f[1] / length, f[2] / length},
                   exact);
    assert_true(error_of_D(&m, exact) < 1e-12);
  }
  composite_close(&m);
}

/* Where bonds are alike in all directions the law is pmb. */
static void without_fibres_it_is_pmb(void **state) {
  (void)state;
  for (int k = 0; k < LATTICES; k++) {
    composite m, plain;
    composite_open(&m, "pmb_fibre", SETTING_PLANE_STRESS, lattices[k]);
    composite_open(&plain, "pmb", SETTING_PLANE_STRESS, lattices[k]);
    *law_case_value(&m.c, "E_1") = *law_case_value(&m.c, "E_2") = *law_case_value(&plain.c, "E");
    set_fibre(&m, 0.3, 0.7, 0);
    measure(&m);
    measure(&plain);
    assert_true(error_of_D(&m, plain.D) < 1e-12);
    composite_close(&plain);
    composite_close(&m);
  }
}

/* --- the solid -------------------------------------------------------------------------------- */

/* Young's modulus of D along x. */
static double modulus_along_x(const double *D) {
  const double minor = D[4] * D[8] - D[5] * D[7];
  const double whole =
      D[0] * minor - D[1] * (D[3] * D[8] - D[5] * D[6]) + D[2] * (D[3] * D[7] - D[4] * D[6]);
  return whole / minor;
}

/* With bonds in all directions alike, loaded at an angle to the fibres, in plane stress: the means
   of cos^4, cos^2 sin^2 and sin^4 over a turn are 3/8, 1/8, 3/8, with cos^8 before them 231/1024,
   21/1024, 7/1024; then the off-axis modulus of an orthotropic solid. */
static double modulus_of_the_solid(double E_1, double E_2, double angle) {
  const double more = E_1 - E_2, C_11 = 3 * (E_2 * 3 / 8 + more * 231 / 1024),
               C_12 = 3 * (E_2 / 8 + more * 21 / 1024), C_22 = 3 * (E_2 * 3 / 8 + more * 7 / 1024);
  const double along = C_11 - C_12 * C_12 / C_22, across = C_22 - C_12 * C_12 / C_11,
               nu = C_12 / C_22, G = C_12, c = cos(angle), s = sin(angle);
  return 1 / (pow(c, 4) / along + pow(s, 4) / across + (1 / G - 2 * nu / along) * c * c * s * s);
}

/* Largest error over all angles. */
static double error_of_modulus(const char *lattice, bool show) {
  composite m;
  double worst = 0;
  composite_open(&m, "pmb_fibre", SETTING_PLANE_STRESS, lattice);
  const double E_1 = *law_case_value(&m.c, "E_1"), E_2 = *law_case_value(&m.c, "E_2");
  for (double angle = 0; angle <= 90; angle += 7.5) {
    set_fibre(&m, cos(degrees(angle)), sin(degrees(angle)), 0);
    measure(&m);
    const double E = modulus_along_x(m.D), exact = modulus_of_the_solid(E_1, E_2, degrees(angle));
    if (show && fmod(angle, 15) == 0)
      print_message("%s, fibres at %g: E = %.3f GPa, of the solid %.3f\n", lattice, angle, 1e-9 * E,
                    1e-9 * exact);
    worst = fmax(worst, fabs(E / exact - 1));
  }
  composite_close(&m);
  return worst;
}

static void a_larger_horizon_nears_the_solid(void **state) {
  (void)state;
  static const struct {
    const char *lattice;
    double least, most; /* error */
  } cases[] = {{"kind = 'hexagonal'", 0.5, 0.65},
               {"kind = 'hexagonal' horizon = 3.015", 0.09, 0.11},
               {"kind = 'hexagonal' horizon = 5.015", 0.06, 0.08},
               {"kind = 'square' horizon = 5.015", 0.04, 0.06}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    const double error = error_of_modulus(cases[k].lattice, true);
    print_message("%s: E is off by %.4f at most\n", cases[k].lattice, error);
    assert_true(error >= cases[k].least && error <= cases[k].most);
  }
}

/* --- bonds break ------------------------------------------------------------------------------ */

/* The share of a particle's bonds whose stretch at breaking is below S. */
static double share_below(composite *m, double S, const double *e) {
  const double S_1 = *law_case_value(&m->c, "S_1"), S_2 = *law_case_value(&m->c, "S_2");
  const rows *w = m->k.lattice;
  int below = 0;
  for (int b = 0; b < w->directions; b++) {
    const pl_bond_class bond = rows_bond_class(w, b);
    const double c = (bond.chord[0] * e[0] + bond.chord[1] * e[1]) / bond.s;
    below += S_2 + (S_1 - S_2) * pow(c, 8) <= S;
  }
  return (double)below / w->directions;
}

/* All bonds stretched alike: those across the fibres go first, those along them last. */
static void bonds_break_by_their_angle(void **state) {
  (void)state;
  const double e[] = {cos(degrees(33)), sin(degrees(33))};
  composite m;
  double before = 0;
  int seen = 0;
  composite_open(&m, "pmb_fibre", SETTING_PLANE_STRESS, "kind = 'hexagonal' horizon = 3.015");
  set_fibre(&m, e[0], e[1], 0);
  patch *p = patch_new(m.c.compiled, m.c.parameters, m.k.lattice, (long[3]){1, 1, 1}, 0, 0);
  for (double S = 0.0035; S < 0.0125; S += 2.7e-4) {
    patch_deform(p, (const double[3][3]){{S, 0, 0}, {0, S, 0}, {0, 0, 0}}, NULL, p->displacement);
    patch_step(p);
    patch_accept(p);
    patch_observe(p);
    const double broken = p->observed[1][p->inside[0]]; /* the law's only output */
    assert_true(fabs(broken - share_below(&m, S, e)) < 1e-12);
    seen += broken > before;
    before = broken;
  }
  assert_true(before == 1 && seen > 5);
  patch_free(p);
  composite_close(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(stiffness_is_the_sum_over_the_bonds),
      cmocka_unit_test(stiffness_in_space_is_the_sum_over_the_bonds),
      cmocka_unit_test(without_fibres_it_is_pmb),
      cmocka_unit_test(a_larger_horizon_nears_the_solid),
      cmocka_unit_test(bonds_break_by_their_angle),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
