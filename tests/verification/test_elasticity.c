/* Elastic constants of the micropolar lattice against isotropy in the plane, for any rotation: from
   the law's symbolic tangent and from bond forces of the compiled kernel, in plane stress and in
   plane strain. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/analysis/implied.h"
#include "runtime/interaction/interaction.h"
#include "tests/verification/case.h"

static const double rotations[] = {0, 17, 23.7, 90}; /* degrees */
static const double ratios[] = {0, 0.1, 0.2, 1.0 / 3};
enum { ROTATIONS = 4, RATIOS = 4 };

static const double spacing = 6.35e-3, thickness = 0.1524; /* m */
static const double modulus = 30e9;                        /* Pa, as the plane sees it */

static law_case law_under_test;

/* A disc of lattice about the origin. */
static void open_disc(deck_case *c, double rotation) {
  char text[600];
  snprintf(
      text, sizeof text,
      "&simulation end_time = 1 /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = %.17g thickness = %.17g rotation = %g /\n"
      "&material lattice = 'c' model = 'mplm_bilinear' /\n"
      "&body lattice = 'c' shape = 'disc' centre = 0, 0 radius = %.17g /\n",
      spacing, thickness, rotation, 4.05 * spacing);
  assert_true(deck_case_lattice(c, text));
  c->lattice->mass = 2323 * c->lattice->volume;
  c->lattice->inertia = 0.1 * c->lattice->mass * spacing * spacing;
}

/* The law without damage: softening begins where no test goes. Hooke's law in plane strain is that
   of plane stress with E/(1 - nu^2) and nu/(1 - nu): E and nu are chosen so that these are
   `modulus` and `seen`. */
static void use_ratio(double seen) {
  const bool strain = law_under_test.model.law->setting == SETTING_PLANE_STRAIN;
  const double nu = strain ? seen / (1 + seen) : seen;
  *law_case_value(&law_under_test, "nu") = nu;
  *law_case_value(&law_under_test, "E") = strain ? modulus * (1 - nu * nu) : modulus;
  *law_case_value(&law_under_test, "S_t") = 0.5;
}

static double worse(double *largest, double value, double expected, double scale) {
  const double error = fabs(value - expected) / scale;
  *largest = fmax(*largest, error);
  return error;
}

/* --- the symbolic tangent --------------------------------------------------------------------- */

/* Isotropy in the plane (Asadollahi 2014, eqs 2.12, 2.24): E, nu, G = E/(2(1 + nu)). */
static void the_tangent_is_isotropic(void **state) {
  (void)state;
  double E = 0, nu = 0, G = 0, coupling = 0;
  for (int r = 0; r < ROTATIONS; r++)
    for (int n = 0; n < RATIOS; n++) {
      deck_case c;
      implied_elasticity e;
      open_disc(&c, rotations[r]);
      use_ratio(ratios[n]);
      assert_true(
          implied_elastic(law_under_test.interpreted, law_under_test.parameters, c.lattice, &e));
      for (int k = 0; k < 2; k++) {
        worse(&E, e.E[k], modulus, modulus);
        worse(&nu, e.nu[k], ratios[n], 1);
        worse(&coupling, e.D[k][2], 0, modulus);
        worse(&coupling, e.D[2][k], 0, modulus);
      }
      worse(&coupling, e.asymmetry, 0, modulus);
      worse(&G, e.G, modulus / (2 * (1 + ratios[n])), modulus);
      deck_case_close(&c);
    }
  print_message("tangent: E %.1e, nu %.1e, G %.1e, shear coupling %.1e (relative)\n", E, nu, G,
                coupling);
  assert_true(E < 1e-12 && nu < 1e-12 && G < 1e-12 && coupling < 1e-12);
}

/* dN/d(stretch, rate, theta_i, theta_j), dM_i/d..., dM_j/d... of a bond at rest. */
static void tangent_at_rest(double tangent[12]) {
  deck_case c;
  open_disc(&c, 17);
  const pl_law *kernel = law_under_test.interpreted;
  const pl_bond_class bond = rows_bond_class(c.lattice, 1);
  double uniforms[64], *out[12], zero = 0, length = spacing;
  assert_true(kernel->uniform_count <= 64 && kernel->field_count == 1);
  kernel->prepare(kernel, law_under_test.parameters, &bond, uniforms);
  const double *in[] = {&zero, &zero, &zero, &zero, &length}, *field[] = {&zero};
  for (int k = 0; k < 12; k++)
    out[k] = &tangent[k];
  const pl_states s = {.size = sizeof s, .count = 1, .in = in, .field = field, .out = out};
  kernel->tangent(kernel, uniforms, &s);
  deck_case_close(&c);
}

/* Axial and bending rigidity of a bond (eq 2.49), and E of the lattice from them (eq 2.24). */
static void rigidities_have_their_closed_forms(void **state) {
  (void)state;
  const double s = spacing, t = thickness, root3 = sqrt(3);
  for (int n = 0; n < RATIOS; n++) {
    const double nu = ratios[n];
    double tangent[12];
    use_ratio(nu);
    tangent_at_rest(tangent);
    const double EA = modulus * s * t / (root3 * (1 - nu));
    const double EI = modulus * s * s * s * t * (1 - 3 * nu) / (12 * root3 * (1 - nu * nu));
    const double expected[12] = {EA,         0,          0, 0, 0,          0,
                                 4 * EI / s, 2 * EI / s, 0, 0, 2 * EI / s, 4 * EI / s};
    for (int k = 0; k < 12; k++) /* 1e-14: a few roundings */
      assert_true(fabs(tangent[k] - expected[k]) <= 1e-14 * fabs(expected[k]));
    const double axial = tangent[0], bending = tangent[6] * s / 4;
    const double E = 2 * axial * (s * s * axial + 12 * bending) /
                     (root3 * s * t * (s * s * axial + 4 * bending));
    assert_true(fabs(E / modulus - 1) < 1e-14);
  }
}

/* The rigidities as the source prints them for plane strain (Gerstle, Honarvar Gheitanbaf and
   Asadollahi 2013, section 3.1): bending vanishes at nu = 1/4. */
static void rigidities_in_plane_strain(void **state) {
  (void)state;
  const double s = spacing, t = thickness, root3 = sqrt(3), E = 30e9;
  for (double nu = 0; nu < 0.26; nu += 0.05) {
    double tangent[12];
    *law_case_value(&law_under_test, "nu") = nu;
    *law_case_value(&law_under_test, "E") = E;
    tangent_at_rest(tangent);
    const double common = E * s * t / (root3 * (1 + nu) * (1 - 2 * nu));
    const double bending = common * s * s * (1 - 4 * nu) / 12;
    assert_true(fabs(tangent[0] / common - 1) < 1e-14);
    assert_true(fabs(tangent[6] * s / 4 - bending) < 1e-14 * common * s * s);
  }
}

/* 30 GPa and 0.2 are 31.25 GPa and 0.25 in the plane; the stresses are those of Hooke's law with no
   strain across it. */
static void the_plane_sees_no_strain_across(void **state) {
  (void)state;
  const double E = 30e9, nu = 0.2, lame = E / ((1 + nu) * (1 - 2 * nu));
  deck_case c;
  implied_elasticity e;
  *law_case_value(&law_under_test, "nu") = nu;
  *law_case_value(&law_under_test, "E") = E;
  open_disc(&c, 23.7);
  assert_true(
      implied_elastic(law_under_test.interpreted, law_under_test.parameters, c.lattice, &e));
  for (int k = 0; k < 2; k++) {
    assert_true(fabs(e.E[k] / 31.25e9 - 1) < 1e-12 && fabs(e.nu[k] - 0.25) < 1e-12);
    assert_true(fabs(e.D[k][k] / (lame * (1 - nu)) - 1) < 1e-12);
    assert_true(fabs(e.D[k][1 - k] / (lame * nu) - 1) < 1e-12);
  }
  assert_true(fabs(e.G / (E / (2 * (1 + nu))) - 1) < 1e-12);
  deck_case_close(&c);
}

/* --- bond forces of the compiled kernel ------------------------------------------------------- */

static sweep *patch_of(const rows *w) {
  return interaction_new(w, law_under_test.compiled, law_under_test.parameters, 1e-7, 1, false,
                         true);
}

/* u = H x at every site, the ghosts too; particles turn with the lattice, which for a hexagon
   balances the moments: the mean of the six chords' rotations is that of H. */
static void deform(sweep *w, const double H[2][2], double factor) {
  const rows *g = w->body->lattice;
  for (long q = 0; q < g->size; q++) {
    w->body->displacement[0][q] = factor * (H[0][0] * g->x[q] + H[0][1] * g->y[q]);
    w->body->displacement[1][q] = factor * (H[1][0] * g->x[q] + H[1][1] * g->y[q]);
    w->body->displacement[2][q] = factor * 0.5 * (H[1][0] - H[0][1]);
  }
}

static long middle_site(const rows *g) {
  for (long p = 0; p < g->particle_count; p++)
    if (hypot(g->x[g->particle_site[p]], g->y[g->particle_site[p]]) < 1e-9 * spacing)
      return g->particle_site[p];
  fail_msg("no particle in the middle");
  return -1;
}

/* Central difference, per unit of H, of the forces in the middle particle's bonds:
   F[direction][plane]. `uneven`: largest difference to any other bond of the direction;
   `unbalanced`: moment left on the particle; both made dimensionless and kept when larger than what
   is there. */
static void unit_forces(sweep *w, const double H[2][2], double F[3][4], double *uneven,
                        double *unbalanced) {
  static const double strain = 5e-6;
  const rows *g = w->body->lattice;
  const size_t count = (size_t)(3 * g->size);
  double *plus[4], *minus[4];
  for (int p = 0; p < 4; p++) {
    plus[p] = calloc(count, sizeof(double));
    minus[p] = calloc(count, sizeof(double));
  }
  deform(w, H, strain);
  all_bond_forces(w, plus);
  deform(w, H, -strain);
  all_bond_forces(w, minus);
  const long middle = middle_site(g);
  double moment =
      0; /* on the middle particle: of the bonds it owns and of those from the other side */
  for (int k = 0; k < 3; k++) {
    for (int c = 0; c < 4; c++)
      F[k][c] = (plus[c][k * g->size + middle] - minus[c][k * g->size + middle]) / (2 * strain);
    moment += F[k][2] + F[k][3];
  }
  *unbalanced = fmax(*unbalanced, fabs(moment) / (modulus * spacing * spacing * thickness));
  for (long b = 0; b < 3 * g->size; b++) {
    const long k = b / g->size;
    if (!rows_has_bond(g, b % g->size, (int)k)) continue;
    for (int c = 0; c < 4; c++)
      *uneven = fmax(*uneven, fabs((plus[c][b] - minus[c][b]) / (2 * strain) - F[k][c]) /
                                  (modulus * spacing * thickness));
  }
  for (int p = 0; p < 4; p++) {
    free(plus[p]);
    free(minus[p]);
  }
}

/* Stress as the force on a particle's half family times the chords, over the particle's volume. */
static void kernel_tangent(const rows *g, double D[3][3], double *uneven, double *asymmetry) {
  static const double strains[3][2][2] = {{{1, 0}, {0, 0}}, {{0, 0}, {0, 1}}, {{0, 0.5}, {0.5, 0}}};
  sweep *w = patch_of(g);
  for (int c = 0; c < 3; c++) {
    double F[3][4], stress[2][2] = {{0}};
    unit_forces(w, strains[c], F, uneven, asymmetry);
    for (int k = 0; k < 3; k++)
      for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
          stress[a][b] += F[k][a] * g->chord[k][b] / (g->site_area * thickness);
    D[0][c] = stress[0][0];
    D[1][c] = stress[1][1];
    D[2][c] = 0.5 * (stress[0][1] + stress[1][0]);
    *asymmetry = fmax(*asymmetry, fabs(stress[0][1] - stress[1][0]) / modulus);
  }
  sweep_free(w);
}

/* 1e-8: the central difference at strain 5e-6 leaves its square, 2.5e-11, and roundings of
 * 1e-16/5e-6 = 2e-11. */
static void the_kernel_is_isotropic(void **state) {
  (void)state;
  double E = 0, nu = 0, G = 0, coupling = 0, uneven = 0, asymmetry = 0;
  for (int r = 0; r < ROTATIONS; r++)
    for (int n = 0; n < RATIOS; n++) {
      deck_case c;
      double D[3][3];
      open_disc(&c, rotations[r]);
      use_ratio(ratios[n]);
      kernel_tangent(c.lattice, D, &uneven, &asymmetry);
      const double det = D[0][0] * D[1][1] - D[0][1] * D[1][0];
      worse(&E, det / D[1][1], modulus, modulus);
      worse(&E, det / D[0][0], modulus, modulus);
      worse(&nu, D[1][0] / D[1][1], ratios[n], 1); /* loaded along x */
      worse(&nu, D[0][1] / D[0][0], ratios[n], 1); /* loaded along y */
      worse(&G, D[2][2], modulus / (2 * (1 + ratios[n])), modulus);
      for (int k = 0; k < 2; k++) {
        worse(&coupling, D[k][2], 0, modulus);
        worse(&coupling, D[2][k], 0, modulus);
      }
      deck_case_close(&c);
    }
  print_message("kernel: E %.1e, nu %.1e, G %.1e, shear coupling %.1e, asymmetry of stress and "
                "moment balance %.1e, particles differ by %.1e\n",
                E, nu, G, coupling, asymmetry, uneven);
  assert_true(E < 1e-8 && nu < 1e-8 && G < 1e-8 && coupling < 1e-8 && asymmetry < 1e-8);
  assert_true(uneven < 1e-8);
}

/* --- unit cell -------------------------------------------------------------------------------- */

/* Force of the bond whose chord makes `degrees` with x, as exerted on the body through the bond's
 * far end. */
static void force_along(const rows *g, double F[3][4], double degrees, double *fx, double *fy) {
  const double a = degrees * acos(-1) / 180;
  for (int k = 0; k < 3; k++) {
    const double c = (g->chord[k][0] * cos(a) + g->chord[k][1] * sin(a)) / spacing;
    if (fabs(c) < 1 - 1e-9) continue;
    *fx = c > 0 ? F[k][0] : -F[k][0];
    *fy = c > 0 ? F[k][1] : -F[k][1];
    return;
  }
  fail_msg("no bond at %g degrees", degrees);
}

/* Forces of the unit cell with one bond along y and four at 30 degrees to x, under unit stress,
   over s t (Asadollahi 2014, eqs 2.50-2.52, with the factor 1 - 3 nu that the print has lost). */
static void unit_cell_forces(void **state) {
  (void)state;
  double largest = 0;
  for (int n = 0; n < RATIOS; n++) {
    const double nu = ratios[n], root3 = sqrt(3);
    /* strains of the unit stresses sigma_xx, sigma_yy, tau_xy, times E */
    const double strain[3][2][2] = {
        {{1, 0}, {0, -nu}}, {{-nu, 0}, {0, 1}}, {{0, 1 + nu}, {1 + nu, 0}}};
    const double X = 0.5, Y = nu / (root3 * (1 - nu));
    const double Y1 = root3 * (1 - 3 * nu) / (6 * (1 - nu)), Y2 = 1 / (root3 * (1 - nu));
    const double X1 = root3 * (1 + 3 * nu) / (6 * (1 - nu)), X2 = (1 - 3 * nu) / (root3 * (1 - nu));
    const double at30[3][2] = {{X, Y}, {0, Y1}, {X1, 0.5}};
    const double at150[3][2] = {{-X, Y}, {0, Y1}, {X1, -0.5}};
    const double at90[3][2] = {{0, -Y}, {0, Y2}, {X2, 0}};
    deck_case c;
    open_disc(&c, 90);
    use_ratio(nu);
    sweep *w = patch_of(c.lattice);
    for (int k = 0; k < 3; k++) {
      double F[3][4], fx = NAN, fy = NAN, unused = 0;
      unit_forces(w, strain[k], F, &unused, &unused);
      const struct {
        double angle;
        const double *expected;
      } bonds[] = {{30, at30[k]}, {150, at150[k]}, {90, at90[k]}};
      for (int b = 0; b < 3; b++) {
        force_along(c.lattice, F, bonds[b].angle, &fx, &fy);
        worse(&largest, fx / (modulus * spacing * thickness), bonds[b].expected[0], 1);
        worse(&largest, fy / (modulus * spacing * thickness), bonds[b].expected[1], 1);
      }
    }
    sweep_free(w);
    deck_case_close(&c);
  }
  print_message("unit cell: forces to %.1e of s t stress\n", largest);
  assert_true(largest < 1e-8); /* as the elastic constants */
}

static int open_law(void **state) {
  (void)state;
  return law_case_open(&law_under_test, "mplm_bilinear") ? 0 : -1;
}

static int open_law_in_plane_strain(void **state) {
  (void)state;
  return law_case_open_in(&law_under_test, "mplm_bilinear", SETTING_PLANE_STRAIN) ? 0 : -1;
}

static int close_law(void **state) {
  (void)state;
  law_case_close(&law_under_test);
  return 0;
}

int main(void) {
  const struct CMUnitTest in_plane_stress[] = {
      cmocka_unit_test(the_tangent_is_isotropic),
      cmocka_unit_test(rigidities_have_their_closed_forms),
      cmocka_unit_test(the_kernel_is_isotropic),
      cmocka_unit_test(unit_cell_forces),
  };
  const struct CMUnitTest in_plane_strain[] = {
      cmocka_unit_test(the_tangent_is_isotropic),
      cmocka_unit_test(rigidities_in_plane_strain),
      cmocka_unit_test(the_plane_sees_no_strain_across),
      cmocka_unit_test(the_kernel_is_isotropic),
  };
  return cmocka_run_group_tests(in_plane_stress, open_law, close_law) +
         cmocka_run_group_tests(in_plane_strain, open_law_in_plane_strain, close_law);
}
