/* What irregular beams make of a uniform strain: rotations in balance, against all of their
   stiffness written out and solved. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/analysis/uniform_strain.h"
#include "runtime/interaction/interaction.h"
#include "tests/runtime/beam_law.h"
#include "tests/runtime/built_rows.h"

/* LAPACK: solves a system of linear equations. */
void dgesv_(const int *n, const int *columns, double *a, const int *lda, int *pivot, double *b,
            const int *ldb, int *info);

#define PLANE                                                                                      \
  "&simulation end_time = 1 /\n&material lattice = 'c' model = 'm' /\n"                            \
  "&lattice name = 'c' kind = 'blue_noise' spacing = 0.01 thickness = 0.1 seed = 5 /\n"            \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.08, 0.06 /\n"
#define SPACE                                                                                      \
  "&simulation end_time = 1 /\n&material lattice = 'c' model = 'm' /\n"                            \
  "&lattice name = 'c' kind = 'blue_noise' setting = 'space' spacing = 0.01 seed = 5 /\n"          \
  "&body lattice = 'c' shape = 'box' corner = 0, 0, 0 size = 0.04, 0.03, 0.03 /\n"

static const double size = 1e-7; /* of strains and rotations */

typedef struct moved {
  sweep *sweep;
  body *body;
  const rows *g;
  int first;  /* component that turns */
  long count; /* of rotations */
} moved;

static double *rotation(const moved *m, long k) {
  const long n = m->g->particle_count;
  return &m->body->displacement[m->first + k / n][m->g->particle_site[k % n]];
}

static double moment(const moved *m, long k) {
  const long n = m->g->particle_count;
  return m->body->force[m->first + k / n][m->g->particle_site[k % n]];
}

/* Column by column, and the moments that the strain at hand leaves: the rotations. */
static void solve_rotations(const moved *m) {
  const int n = (int)m->count, one = 1;
  double *K = test_calloc((size_t)n * (size_t)n, sizeof *K);
  double *left = test_calloc((size_t)n, sizeof *left);
  int *pivot = test_calloc((size_t)n, sizeof *pivot), info;
  sweep_find_forces(m->sweep);
  for (int k = 0; k < n; k++)
    left[k] = moment(m, k);
  for (int c = 0; c < n; c++) {
    *rotation(m, c) = size;
    sweep_find_forces(m->sweep);
    *rotation(m, c) = 0;
    for (int r = 0; r < n; r++)
      K[r + n * c] = (left[r] - moment(m, r)) / size;
  }
  dgesv_(&n, &one, K, &n, pivot, left, &n, &info);
  assert_int_equal(info, 0);
  for (int k = 0; k < n; k++)
    *rotation(m, k) = left[k];
  test_free(K);
  test_free(left);
  test_free(pivot);
}

/* -sum(f x)/V of the body at hand, over its strain. */
static double stress(const moved *m, int a, int b) {
  double sum = 0, volume = 0;
  for (long p = 0; p < m->g->particle_count; p++) {
    const long q = m->g->particle_site[p];
    double at[3];
    rows_place(m->g, q, at);
    sum -= (m->body->force[a][q] * at[b] + m->body->force[b][q] * at[a]) / 2;
    volume += m->g->site_volume[q];
  }
  return sum / volume / size;
}

/* Voigt's mean of the stresses under extension along each axis and shear in each plane: Young's
   modulus. */
static double modulus(const moved *m, bool turning) {
  const int d = m->body->dimensions;
  double normal = 0, mixed = 0, shear = 0;
  for (int a = 0; a < d; a++)
    for (int b = a; b < d; b++) {
      for (long p = 0; p < m->g->particle_count; p++) {
        const long q = m->g->particle_site[p];
        double at[3];
        rows_place(m->g, q, at);
        for (int c = 0; c < m->body->dof; c++)
          m->body->displacement[c][q] = 0;
        m->body->displacement[a][q] += size * at[b] / 2;
        m->body->displacement[b][q] += size * at[a] / 2;
      }
      if (turning) solve_rotations(m);
      sweep_find_forces(m->sweep);
      if (a != b) shear += stress(m, a, b);
      for (int c = 0; c < d && a == b; c++)
        *(c == a ? &normal : &mixed) += c == a ? stress(m, c, c) : stress(m, c, c) / 2;
    }
  if (d == 2) {
    const double k = (normal + 2 * mixed) / 4, G = (normal - 2 * mixed + 4 * shear) / 8;
    return 4 * k * G / (k + G);
  }
  const double K = (normal + 2 * mixed) / 9, G = (normal - mixed + 3 * shear) / 15;
  return 9 * K * G / (3 * K + G);
}

static void rotations_are_in_balance(void **state) {
  (void)state;
  static const char *const decks[] = {PLANE, SPACE};
  for (int k = 0; k < 2; k++) {
    const pl_law law = beams_in(2 + k, PL_LIST);
    double parameters[BEAM_PARAMETERS];
    uniform_response found;
    built_rows b;
    for (int p = 0; p < BEAM_PARAMETERS; p++)
      parameters[p] = beam_parameters[p].initial;
    build_rows(&b, decks[k]);
    rows_set_density(b.rows, 2000);
    moved m = {.g = b.rows, .first = law.dimensions};
    m.sweep = interaction_new(b.rows, &law, parameters, 1e-9, 1, false, true);
    m.body = m.sweep->body;
    m.count = (law.dof - law.dimensions) * b.rows->particle_count;
    assert_true(uniform_strain_response(&law, parameters, NULL, b.rows, false, &found));
    const double held = modulus(&m, false), balanced = modulus(&m, true);
    print_message("%ld particles: E %.9g Pa, held rotations %.9g Pa\n", b.rows->particle_count,
                  found.E, held);
    assert_true(fabs(found.E / balanced - 1) < 1e-7);
    assert_true(held > 1.001 * balanced);
    sweep_free(m.sweep);
    built_end(&b);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(rotations_are_in_balance)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
