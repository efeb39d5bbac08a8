/* Force constants read off a law's own step: against theory, against the bonds' tangents, and
   against what a body does at steps just below and just above the limit. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/analysis/implied.h"
#include "runtime/analysis/patch.h"
#include "runtime/analysis/stability.h"
#include "runtime/analysis/stencil.h"
#include "tests/runtime/beam_law.h"
#include "tests/runtime/elastic_law.h"
#include "tests/runtime/family_law.h"
#include "tests/runtime/spring_law.h"

static const double spacing = 0.01, thickness = 0.1;

static void values_of(double *parameters, double nu, double tau) {
  for (int p = 0; p < FAMILY_PARAMETERS; p++)
    parameters[p] = family_parameters[p].initial;
  parameters[FAMILY_NU] = nu;
  parameters[FAMILY_TAU] = tau;
}

static void rigid_motions_leave_no_force(void **state) {
  (void)state;
  double parameters[FAMILY_PARAMETERS];
  rows *w = implied_lattice(spacing, thickness, 2323);
  values_of(parameters, 0.2, 1e-7);
  stencil s = stencil_new(&family_hexagon, parameters, w);
  assert_true(s.finite);
  assert_true(s.imbalance < 1e-9);
  assert_int_equal(s.count, 25);
  long reached = 0; /* two chords far: the hexagon's 18 neighbours of neighbours and the particle */
  for (int n = 0; n < s.count; n++)
    reached += fabs(s.blocks[n].stiffness[0][0]) + fabs(s.blocks[n].stiffness[1][1]) >
               1e-9 * s.blocks[0].stiffness[0][0];
  assert_int_equal(reached, 19);
  stencil_free(&s);
  rows_free(w);
}

/* Nikravesh 2017: omega_max = sqrt(6 a/(L0 m)). */
static void largest_frequency_is_that_of_theory(void **state) {
  (void)state;
  const double ratios[] = {0.1, 0.2, 0.3, 1.0 / 3};
  for (int k = 0; k < 4; k++) {
    double parameters[FAMILY_PARAMETERS];
    values_of(parameters, ratios[k], 0);
    rows *w = implied_lattice(spacing, thickness, 2323);
    const double a = 2 * 30e9 * spacing * thickness / (sqrt(3) * (1 + ratios[k]));
    const double omega = sqrt(6 * a / (spacing * w->mass));
    step_limit limit;
    stability_limit(&family_hexagon, parameters, NULL, w, &limit);
    assert_true(fabs(limit.omega_max - omega) <= 1e-9 * omega);
    assert_true(limit.limit == stability_rounded(2 / limit.omega_max));
    assert_true(limit.damping_ratio == 0);
    rows_free(w);
  }
}

/* Without b (nu = 1/3) the law is one of bonds: both ways to the limit must agree, damped too. */
static void bonds_and_families_have_the_same_limit(void **state) {
  (void)state;
  const double times[] = {0, 1e-7, 3e-6};
  for (int k = 0; k < 3; k++) {
    double mine[FAMILY_PARAMETERS], bonds[ELASTIC_PARAMETERS];
    values_of(mine, 1.0 / 3, times[k]);
    for (int p = 0; p < ELASTIC_PARAMETERS; p++)
      bonds[p] = elastic_parameters[p].initial;
    bonds[ELASTIC_NU] = 1.0 / 3;
    bonds[ELASTIC_TAU] = times[k];
    rows *w = implied_lattice(spacing, thickness, 2323);
    step_limit families, pairs;
    stability_limit(&family_hexagon, mine, NULL, w, &families);
    stability_limit(&elastic_bar, bonds, NULL, w, &pairs);
    assert_true(fabs(families.omega_max - pairs.omega_max) <= 1e-9 * pairs.omega_max);
    assert_true(fabs(families.limit - pairs.limit) <= 1e-9 * pairs.limit);
    assert_true(fabs(families.damping_ratio - pairs.damping_ratio) <= 1e-6 * pairs.damping_ratio);
    assert_true((pairs.damping_ratio > 0) == (times[k] > 0));
    rows_free(w);
  }
}

static void long_waves_give_the_elastic_constants(void **state) {
  (void)state;
  const double ratios[] = {0.05, 0.2, 0.33};
  for (int k = 0; k < 3; k++) {
    double parameters[FAMILY_PARAMETERS];
    values_of(parameters, ratios[k], 0);
    rows *w = implied_lattice(spacing, thickness, 2323);
    implied_elasticity e;
    assert_true(implied_elastic(&family_hexagon, parameters, w, &e));
    for (int c = 0; c < 2; c++) {
      assert_true(fabs(e.E[c] - 30e9) <= 1e-9 * 30e9);
      assert_true(fabs(e.nu[c] - ratios[k]) <= 1e-9);
    }
    assert_true(fabs(e.G - 30e9 / (2 * (1 + ratios[k]))) <= 1e-9 * 30e9);
    rows_free(w);
  }
}

/* --- in space --------------------------------------------------------------------------------- */

static rows *space_lattice(const char *kind, double horizon) {
  const deck_lattice l = {
      .kind = kind, .spacing = spacing, .horizon = horizon, .rotation = 0.3, .axis = {1, 2, 3}};
  rows *w = implied_lattice_like(&l, 2000);
  assert_non_null(w);
  return w;
}

/* Springs k = c/s between nearest neighbours: omega^2 m = 4 k on the cubic lattice (the zone's
   corners), 8 k on the face-centred one (at X). */
static void springs_in_space_have_their_frequencies(void **state) {
  (void)state;
  const struct {
    const char *kind;
    double square;
  } lattices[] = {{"cubic", 4}, {"fcc", 8}};
  for (int n = 0; n < 2; n++) {
    rows *w = space_lattice(lattices[n].kind, 0);
    const double parameters[] = {1e5, 2000};
    const double omega = sqrt(lattices[n].square * 1e5 / spacing / w->mass);
    step_limit limit;
    stability_limit(&springs, parameters, NULL, w, &limit);
    assert_true(fabs(limit.omega_max - omega) <= 1e-7 * omega);
    rows_free(w);
  }
}

/* Springs along bonds r: C = sum over half of the bonds of c r^4/(s V) (Cauchy), shear strains as
   angles. */
static void springs_in_space_have_their_stiffness(void **state) {
  (void)state;
  static const int pair[][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
  const double horizons[] = {0, 2.01};
  for (int n = 0; n < 2; n++) {
    rows *w = space_lattice("fcc", horizons[n]);
    const double parameters[] = {1e5, 2000};
    double D[36], largest = 0;
    stencil s = stencil_new(&springs, parameters, w);
    stencil_elastic(&s, w, D);
    for (int i = 0; i < 36; i++)
      largest = fmax(largest, D[i]);
    for (int i = 0; i < 36; i++) {
      double sum = 0;
      for (int k = 0; k < w->directions; k++) {
        const double *r = w->chord[k], length = w->length[k];
        sum += 1e5 * w->weight[k] / (length * length * length) * r[pair[i / 6][0]] *
               r[pair[i / 6][1]] * r[pair[i % 6][0]] * r[pair[i % 6][1]];
      }
      assert_true(fabs(D[i] - sum / w->volume) <= 1e-7 * largest);
    }
    stencil_free(&s);
    rows_free(w);
  }
}

/* --- particles that rotate -------------------------------------------------------------------- */

/* LAPACK: eigenvalues of a symmetric matrix, ascending. */
void dsyev_(const char *job, const char *triangle, const int *n, double *a, const int *lda,
            double *values, double *work, const int *work_size, int *info, size_t job_length,
            size_t triangle_length);

/* The hexagon of Asadollahi 2014 (eq 2.49) as beams of either form. */
static void hexagon_of_beams(double nu, double *families, double *bonds) {
  const double E = 30e9, s = spacing, t = thickness;
  const double EA = E * s * t / (sqrt(3) * (1 - nu));
  const double EI = E * s * s * s * t * (1 - 3 * nu) / (12 * sqrt(3) * (1 - nu * nu));
  for (int p = 0; p < BEAM_PARAMETERS; p++)
    families[p] = beam_parameters[p].initial;
  for (int p = 0; p < ELASTIC_PARAMETERS; p++)
    bonds[p] = elastic_parameters[p].initial;
  families[BEAM_N] = EA / s;
  families[BEAM_S] = 12 * EI / (s * s * s);
  bonds[ELASTIC_NU] = nu;
}

/* Below nu = 0.1765 the rotation mode rules. The differences leave 3e-10. */
static void beams_of_both_forms_have_one_limit_and_the_same_moduli(void **state) {
  (void)state;
  const pl_law law = beams_in(2, PL_ROWS);
  const double ratios[] = {0.05, 0.2, 0.3}, times[] = {0, 1e-7, 3e-6};
  for (int k = 0; k < 9; k++) {
    double mine[BEAM_PARAMETERS], bonds[ELASTIC_PARAMETERS];
    step_limit families, pairs;
    implied_elasticity e, f;
    rows *w = implied_lattice(spacing, thickness, 2323);
    hexagon_of_beams(ratios[k % 3], mine, bonds);
    mine[BEAM_TAU] = bonds[ELASTIC_TAU] = times[k / 3];
    stability_limit(&law, mine, NULL, w, &families);
    stability_limit(&elastic_beam, bonds, NULL, w, &pairs);
    assert_true(fabs(families.omega_max / pairs.omega_max - 1) < 1e-9);
    assert_true(fabs(families.limit / pairs.limit - 1) < 1e-8);
    assert_string_equal(families.mode, pairs.mode);
    assert_false(families.at_surface);
    assert_true(families.least == 0); /* bonds are definite: no body was looked at */
    assert_true(implied_elastic(&law, mine, w, &e) && implied_elastic(&elastic_beam, bonds, w, &f));
    for (int c = 0; c < 2; c++) {
      assert_true(fabs(e.E[c] / f.E[c] - 1) < 1e-9);
      assert_true(fabs(e.nu[c] - f.nu[c]) < 1e-9);
    }
    assert_true(fabs(e.G / f.G - 1) < 1e-9);
    rows_free(w);
  }
}

static rows *turned_lattice(const char *kind, int shells, double turn) {
  const deck_lattice l = {.kind = kind,
                          .setting = bravais_dimensions(kind) == 2 ? "plane_stress" : NULL,
                          .spacing = spacing,
                          .shells = shells,
                          .rotation = turn,
                          .axis = {1, 2, 3},
                          .thickness = thickness,
                          .stiffness_thickness = thickness,
                          .mass_thickness = thickness};
  rows *w = implied_lattice_like(&l, 2000);
  assert_non_null(w);
  return w;
}

static double apart(double a, double b, double scale) {
  return fabs(a - b) / scale;
}

/* Beams of FCC with 18 neighbours whose stiffnesses are tuned (beam_isotropic) make an isotropic
   solid, however the lattice stands: D is that of Hooke's law. Untuned they do not. */
static void tuned_beams_in_space_are_isotropic(void **state) {
  (void)state;
  const pl_law law = beams_in(3, PL_ROWS);
  const double ratios[] = {0, 0.2, 0.25}, turns[] = {0, 0.4, 1.1}, E = 30e9;
  double worst = 0, parameters[BEAM_PARAMETERS], D[36];
  for (int k = 0; k < 9; k++) {
    const double nu = ratios[k % 3], lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
    const double mu = E / (2 * (1 + nu));
    rows *w = turned_lattice("fcc", 2, turns[k / 3]);
    beam_isotropic(E, nu, spacing, parameters);
    stencil s = stencil_new(&law, parameters, w);
    stencil_elastic(&s, w, D);
    for (int i = 0; i < 36; i++) {
      const int p = i / 6, q = i % 6;
      const double hooke = (p < 3 && q < 3 ? lambda : 0) + (p == q ? (p < 3 ? 2 * mu : mu) : 0);
      worst = fmax(worst, apart(D[i], hooke, E));
    }
    stencil_free(&s);
    parameters[BEAM_N2] *= 1.1;
    s = stencil_new(&law, parameters, w);
    stencil_elastic(&s, w, D);
    assert_true(k >= 3 || apart(D[0] - D[1], 2 * D[21], E) > 1e-3);
    stencil_free(&s);
    rows_free(w);
  }
  print_message("tuned beams in space: D to %.1e of E\n", worst);
  assert_true(worst < 1e-12);
}

/* The largest frequency of a periodic body of so many particles a side, from all of its stiffness
   by differences of forces. */
static double dense_frequency(const pl_law *law, const double *parameters, const rows *w,
                              long side) {
  const long period[3] = {side, side, law->dimensions == 3 ? side : 1};
  patch *p = patch_new(law, parameters, w, period, 0, 0);
  const int n = (int)p->inside_count * law->dof, work_size = 64 * n;
  double *K = test_calloc((size_t)n * (size_t)n, sizeof *K);
  double *values = test_calloc((size_t)n, sizeof *values);
  double *work = test_calloc((size_t)work_size, sizeof *work);
  int info;
  for (int c = 0; c < n; c++)
    for (int side_of = 1; side_of >= -1; side_of -= 2) {
      const int d = c / (int)p->inside_count;
      const double size = 1e-7 * (d < law->dimensions ? spacing : 1);
      p->displacement[d][p->inside[c % (int)p->inside_count]] = side_of * size;
      patch_repeat(p, p->displacement[d]);
      patch_step(p);
      for (int r = 0; r < n; r++) {
        const int a = r / (int)p->inside_count;
        const double scale = sqrt((a < law->dimensions ? w->mass : w->inertia) *
                                  (d < law->dimensions ? w->mass : w->inertia));
        K[r + n * c] -=
            side_of * p->force[a][p->inside[r % (int)p->inside_count]] / (2 * size * scale);
      }
      p->displacement[d][p->inside[c % (int)p->inside_count]] = 0;
      patch_repeat(p, p->displacement[d]);
    }
  dsyev_("N", "U", &n, K, &n, values, work, &work_size, &info, 1, 1);
  assert_int_equal(info, 0);
  const double largest = sqrt(values[n - 1]);
  test_free(K);
  test_free(values);
  test_free(work);
  patch_free(p);
  return largest;
}

/* Largest velocity (rotations times the spacing) after so many steps of a periodic body that begins
   at random, over what it began with, or as soon as it is 1e4 times that. */
static double growth(const pl_law *law, const double *parameters, const rows *w, double dt,
                     int steps) {
  const long period[3] = {2, 2, law->dimensions == 3 ? 2 : 1};
  patch *p = patch_new(law, parameters, w, period, 0, 0);
  const double quiet = 1e-7;
  uint64_t bits = 7;
  double largest = 0;
  for (int d = 0; d < law->dof; d++)
    for (long k = 0; k < p->inside_count; k++) {
      bits = bits * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
      p->velocity[d][p->inside[k]] =
          quiet * ((double)(bits >> 11) * 0x1p-52 - 1) / (d < law->dimensions ? 1 : spacing);
    }
  for (int step = 0; step < steps && largest < 1e4 * quiet; step++) {
    patch_step(p);
    largest = 0;
    for (int d = 0; d < law->dof; d++) {
      const bool turns = d >= law->dimensions;
      for (long k = 0; k < p->inside_count; k++) {
        const long q = p->inside[k];
        p->velocity[d][q] += dt * p->force[d][q] / (turns ? w->inertia : w->mass);
        p->displacement[d][q] += dt * p->velocity[d][q];
        largest = fmax(largest, fabs(p->velocity[d][q]) * (turns ? spacing : 1));
      }
      patch_repeat(p, p->velocity[d]);
      patch_repeat(p, p->displacement[d]);
    }
  }
  patch_free(p);
  return largest / quiet;
}

/* The fastest wave of these lattices is one of those that a period of two or four sites holds, so
   that a small periodic body has it: the same frequency, and the same step. Beams stiff along, and
   stiff across, so that rotations rule. */
static void beams_bear_the_limit_and_no_more(void **state) {
  (void)state;
  const struct {
    const char *kind;
    int shells;
    double across, inertia; /* over along; over that of a ball */
    const char *mode;
  } cases[] = {{"square", 1, 0.3, 1, "rotation"},  {"square", 1, 0.1, 1, "translation"},
               {"hexagonal", 1, 1, 1, "rotation"}, {"cubic", 1, 0.3, 1, "rotation"},
               {"fcc", 2, 0.1, 2, "translation"},  {"fcc", 2, 1, 1, "rotation"}};
  for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
    double parameters[BEAM_PARAMETERS];
    rows *w = turned_lattice(cases[n].kind, cases[n].shells, 0.3);
    const pl_law law = beams_in(w->dimensions, PL_ROWS);
    step_limit l;
    for (int p = 0; p < BEAM_PARAMETERS; p++)
      parameters[p] = beam_parameters[p].initial;
    parameters[BEAM_S] = parameters[BEAM_S2] = cases[n].across * parameters[BEAM_N];
    w->inertia *= cases[n].inertia;
    stability_limit(&law, parameters, NULL, w, &l);
    const double dense = dense_frequency(&law, parameters, w, 2);
    const double below = growth(&law, parameters, w, 0.999 * l.limit, 3000),
                 above = growth(&law, parameters, w, 1.001 * l.limit, 3000);
    print_message("%s, %s: omega %.9g 1/s, a periodic body's %.9g; growth %.3g and %.3g\n",
                  cases[n].kind, l.mode, l.omega_max, dense, below, above);
    assert_string_equal(l.mode, cases[n].mode);
    assert_true(fabs(l.omega_max / dense - 1) < 1e-9);
    assert_true(below < 100 && above > 1e4);
    rows_free(w);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rigid_motions_leave_no_force),
      cmocka_unit_test(largest_frequency_is_that_of_theory),
      cmocka_unit_test(bonds_and_families_have_the_same_limit),
      cmocka_unit_test(long_waves_give_the_elastic_constants),
      cmocka_unit_test(springs_in_space_have_their_frequencies),
      cmocka_unit_test(springs_in_space_have_their_stiffness),
      cmocka_unit_test(beams_of_both_forms_have_one_limit_and_the_same_moduli),
      cmocka_unit_test(tuned_beams_in_space_are_isotropic),
      cmocka_unit_test(beams_bear_the_limit_and_no_more),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
