#include "tests/benchmark/family_problem.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"

motions motions_new(const rows *lattice, int dof) {
  motions m = {.dimensions = lattice->dimensions, .dof = dof};
  for (int d = 0; d < m.dof; d++) {
    m.displacement[d] = must_calloc((size_t)lattice->size, sizeof(double));
    m.velocity[d] = must_calloc((size_t)lattice->size, sizeof(double));
  }
  return m;
}

void motions_free(motions *m) {
  for (int d = 0; d < m->dof; d++) {
    free(m->displacement[d]);
    free(m->velocity[d]);
  }
}

/* Uniform in (-1, 1): Marsaglia's xorshift64 (2003). */
static double random_sign(uint64_t *state) {
  *state ^= *state << 13;
  *state ^= *state >> 7;
  *state ^= *state << 17;
  return (double)(int64_t)*state * 0x1p-63;
}

void motions_start(motions *m, const family_problem *p, double stretch) {
  uint64_t random = UINT64_C(0x9e3779b97f4a7c15);
  for (long q = 0; q < p->lattice->size; q++)
    for (int d = 0; d < m->dof; d++) {
      const double size = d < m->dimensions ? stretch * p->lattice->spacing : stretch;
      const bool present = p->lattice->present[q];
      m->displacement[d][q] = present ? size * random_sign(&random) : 0;
      m->velocity[d][q] = present ? size / (10 * p->time_step) * random_sign(&random) : 0;
    }
}

void motions_scale(double *const *u, double *const *v, const motions *from,
                   const family_problem *p) {
  const double s = p->lattice->spacing;
  for (int d = 0; d < from->dimensions; d++)
    for (long q = 0; q < p->lattice->size; q++) {
      u[d][q] = from->displacement[d][q] / s;
      v[d][q] = from->velocity[d][q] * p->time_step / s;
    }
}

void motions_unscale(motions *to, double *const *u, double *const *v, const family_problem *p) {
  const double s = p->lattice->spacing;
  for (int d = 0; d < to->dimensions; d++)
    for (long q = 0; q < p->lattice->size; q++) {
      to->displacement[d][q] = u[d][q] * s;
      to->velocity[d][q] = v[d][q] * s / p->time_step;
    }
}

static double larger(double a, double b) {
  return isnan(b) ? INFINITY : fmax(a, b);
}

typedef struct outline {
  double low[3], high[3];
} outline;

static outline outline_of(const rows *g, double margin) {
  outline box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (long p = 0; p < g->particle_count; p++) {
    double at[3];
    rows_place(g, g->particle_site[p], at);
    for (int d = 0; d < 3; d++) {
      box.low[d] = fmin(box.low[d], at[d]);
      box.high[d] = fmax(box.high[d], at[d]);
    }
  }
  for (int d = 0; d < g->dimensions; d++) {
    box.low[d] += margin * g->spacing;
    box.high[d] -= margin * g->spacing;
  }
  return box;
}

static bool is_inside(const outline *box, const rows *g, long site) {
  double at[3];
  rows_place(g, site, at);
  for (int d = 0; d < 3; d++)
    if (at[d] < box->low[d] || at[d] > box->high[d]) return false;
  return true;
}

/* Largest |a - b| inside over largest |a|, of so many components. */
static double difference(double *const *a, double *const *b, int count, const rows *g,
                         const outline *box) {
  double most = 0, scale = 0;
  for (int d = 0; d < count; d++)
    for (long p = 0; p < g->particle_count; p++) {
      const long q = g->particle_site[p];
      scale = larger(scale, fabs(a[d][q]));
      if (is_inside(box, g, q)) most = larger(most, fabs(a[d][q] - b[d][q]));
    }
  return most / scale;
}

double motions_difference(const motions *a, const motions *b, const rows *lattice, double margin) {
  const outline box = outline_of(lattice, margin);
  const int n = a->dimensions, turns = a->dof - n;
  const double moved = larger(difference(a->displacement, b->displacement, n, lattice, &box),
                              difference(a->velocity, b->velocity, n, lattice, &box));
  if (turns == 0) return moved;
  return larger(moved,
                larger(difference(a->displacement + n, b->displacement + n, turns, lattice, &box),
                       difference(a->velocity + n, b->velocity + n, turns, lattice, &box)));
}
