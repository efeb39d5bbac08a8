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
#include "runtime/analysis/stability.h"
#include "runtime/analysis/stencil.h"
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

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rigid_motions_leave_no_force),
      cmocka_unit_test(largest_frequency_is_that_of_theory),
      cmocka_unit_test(bonds_and_families_have_the_same_limit),
      cmocka_unit_test(long_waves_give_the_elastic_constants),
      cmocka_unit_test(springs_in_space_have_their_frequencies),
      cmocka_unit_test(springs_in_space_have_their_stiffness),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
