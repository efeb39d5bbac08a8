#include "tests/benchmark/problem.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

double problem_axial_rigidity(const problem *p) {
  return p->law.E * p->lattice->spacing * p->lattice->stiffness_thickness /
         (sqrt(3) * (1 - p->law.nu));
}

double problem_bending_rigidity(const problem *p) {
  const double s = p->lattice->spacing, nu = p->law.nu;
  return p->law.E * s * s * s * p->lattice->stiffness_thickness * (1 - 3 * nu) /
         (12 * sqrt(3) * (1 - nu * nu));
}

motion motion_new(const rows *lattice) {
  motion m;
  for (int d = 0; d < 3; d++) {
    m.displacement[d] = must_calloc((size_t)lattice->size, sizeof(double));
    m.velocity[d] = must_calloc((size_t)lattice->size, sizeof(double));
  }
  m.damage = must_calloc((size_t)(lattice->directions * lattice->size), sizeof(double));
  return m;
}

void motion_free(motion *m) {
  for (int d = 0; d < 3; d++) {
    free(m->displacement[d]);
    free(m->velocity[d]);
  }
  free(m->damage);
}

/* Uniform in (-1, 1): Marsaglia's xorshift64 (2003). */
static double random_sign(uint64_t *state) {
  *state ^= *state << 13;
  *state ^= *state >> 7;
  *state ^= *state << 17;
  return (double)(int64_t)*state * 0x1p-63;
}

void motion_start(motion *m, const problem *p, double stretch, double turn) {
  const rows *g = p->lattice;
  const double centre[2] = {g->x[g->particle_site[0]] + g->width / 2,
                            g->y[g->particle_site[0]] + g->height / 2};
  uint64_t random = UINT64_C(0x9e3779b97f4a7c15);
  memset(m->damage, 0, (size_t)(g->directions * g->size) * sizeof *m->damage);
  for (long q = 0; q < g->size; q++) {
    const double x = g->x[q] - centre[0], y = g->y[q] - centre[1];
    const double rigid[3] = {(cos(turn) - 1) * x - sin(turn) * y,
                             sin(turn) * x + (cos(turn) - 1) * y, turn};
    for (int d = 0; d < 3; d++) {
      const double size = stretch * (d < 2 ? g->spacing : 1);
      m->displacement[d][q] = g->present[q] ? rigid[d] + size * random_sign(&random) : 0;
      m->velocity[d][q] = g->present[q] ? size / (10 * p->time_step) * random_sign(&random) : 0;
    }
  }
}

static double larger(double a, double b) {
  return isnan(b) ? INFINITY : fmax(a, b);
}

static double velocity_scale(const motion *m, const rows *lattice, int d) {
  double most = 0;
  for (long q = 0; q < lattice->size; q++)
    if (lattice->present[q]) most = larger(most, fabs(m->velocity[d][q]));
  return most;
}

double motion_difference(const motion *a, const motion *b, const rows *lattice) {
  double most = 0;
  for (int d = 0; d < 3; d++) {
    const double scale = d < 2 ? fmax(velocity_scale(a, lattice, 0), velocity_scale(a, lattice, 1))
                               : velocity_scale(a, lattice, 2);
    for (long q = 0; q < lattice->size; q++)
      if (lattice->present[q])
        most = larger(most, fabs(a->velocity[d][q] - b->velocity[d][q]) / scale);
  }
  for (int k = 0; k < lattice->directions; k++)
    for (long q = 0; q < lattice->size; q++) {
      const long slot = k * lattice->size + q;
      if (rows_has_bond(lattice, q, k))
        most = larger(most, fabs(a->damage[slot] - b->damage[slot]));
    }
  return most;
}

double motion_damaged(const motion *m, const rows *lattice, double least) {
  long damaged = 0;
  for (int k = 0; k < lattice->directions; k++)
    for (long q = 0; q < lattice->size; q++)
      if (rows_has_bond(lattice, q, k)) damaged += m->damage[k * lattice->size + q] > least;
  return (double)damaged / (double)lattice->bond_count;
}
