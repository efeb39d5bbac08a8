#include <math.h>

#include "tests/benchmark/bond_lanes.h"
#include "tests/benchmark/handwritten_families.h"

/* Two turns over the rows. The first finds the stretches of the bonds that a row owns and adds them
   to the sums of both ends; the second, as many rows behind as a bond reaches, finds their forces
   and moves the row. Between the turns the stretches stand in a ring of rows that stays in the
   second cache. Sums and forces go to the far end as they come: a row is complete when its turn is.
   */

enum { DIRECTIONS = 9 };

typedef struct elastic_fcc {
  const family_problem *problem;
  double chord[DIRECTIONS][3];    /* spacings */
  double growth[DIRECTIONS][3];   /* 2 chord/length^2 */
  double square[DIRECTIONS];      /* (1/length)^2 */
  double weight[DIRECTIONS];      /* of the stretch in the sum: length b/2 */
  double stiffness[DIRECTIONS];   /* spacings a step, of a bond's full stretch by its force */
  double *u[3], *v[3], *force[3]; /* [size] spacings; spacings a step; the same a step, more */
  double *sum;                    /* [size] */
  double *ring; /* [ring_rows][DIRECTIONS][2][pitch] stretch; 1/length now, 0 where no bond is */
  int reach, ring_rows;
} elastic_fcc;

static double *ring_of(const elastic_fcc *h, int row, int k) {
  return h->ring + ((long)(row % h->ring_rows) * DIRECTIONS + k) * 2 * h->problem->lattice->pitch;
}

static void find_bonds(elastic_fcc *h, int row, int k) {
  const rows *g = h->problem->lattice;
  const long near = rows_start(g, row), offset = rows_offset(g, row, k);
  const double *x = h->u[0] + near, *y = h->u[1] + near, *z = h->u[2] + near;
  const uint64_t *bonds = g->bonds + near;
  const double *growth = h->growth[k];
  const double to_x = growth[0], to_y = growth[1], to_z = growth[2], square = h->square[k],
               half_weight = 0.5 * h->weight[k], root = sqrt(square);
  double *sum = h->sum + near, *to_stretch = ring_of(h, row, k),
         *to_inverse = to_stretch + g->pitch;
  for (long q = 0; q < g->pitch; q += LANES) {
    const lanes_marks exists = lanes_marked(bonds + q, UINT64_C(1) << k);
    const lanes d_x = lanes_load(x + q + offset) - lanes_load(x + q),
                d_y = lanes_load(y + q + offset) - lanes_load(y + q),
                d_z = lanes_load(z + q + offset) - lanes_load(z + q);
    const bond_lanes bond = bond_of_growth((to_x * d_x + to_y * d_y + to_z * d_z) +
                                           square * (d_x * d_x + d_y * d_y + d_z * d_z));
    const lanes twice = lanes_keep(exists, bond.twice), part = half_weight * twice;
    lanes_store(to_stretch + q, 0.5 * twice);
    lanes_store(to_inverse + q, lanes_keep(exists, root * bond.inverse));
    lanes_store(sum + q, lanes_load(sum + q) + part);
    lanes_store(sum + q + offset, lanes_load(sum + q + offset) + part);
  }
}

static void find_forces(elastic_fcc *h, int row, int k) {
  const rows *g = h->problem->lattice;
  const long near = rows_start(g, row), offset = rows_offset(g, row, k);
  const double *sum = h->sum + near, *stretch = ring_of(h, row, k), *inverse = stretch + g->pitch;
  const double *u[3] = {h->u[0] + near, h->u[1] + near, h->u[2] + near};
  double *force[3] = {h->force[0] + near, h->force[1] + near, h->force[2] + near};
  const double stiffness = h->stiffness[k];
  const double chord[3] = {h->chord[k][0], h->chord[k][1], h->chord[k][2]};
  for (long q = 0; q < g->pitch; q += LANES) {
    const lanes N =
        stiffness * lanes_load(stretch + q) + (lanes_load(sum + q) + lanes_load(sum + q + offset));
    const lanes per_length = N * lanes_load(inverse + q);
    for (int d = 0; d < 3; d++) {
      const lanes f =
          per_length * (chord[d] + (lanes_load(u[d] + q + offset) - lanes_load(u[d] + q)));
      lanes_store(force[d] + q, lanes_load(force[d] + q) + f);
      lanes_store(force[d] + q + offset, lanes_load(force[d] + q + offset) - f);
    }
  }
}

static void move_row(elastic_fcc *h, int row) {
  const long start = rows_start(h->problem->lattice, row), pitch = h->problem->lattice->pitch;
  double *sum = h->sum + start;
  for (int d = 0; d < 3; d++) {
    double *u = h->u[d] + start, *v = h->v[d] + start, *force = h->force[d] + start;
    for (long q = 0; q < pitch; q += LANES) {
      const lanes next = lanes_load(v + q) + lanes_load(force + q);
      lanes_store(v + q, next);
      lanes_store(u + q, lanes_load(u + q) + next);
      lanes_store(force + q, lanes_all(0));
    }
  }
  for (long q = 0; q < pitch; q += LANES)
    lanes_store(sum + q, lanes_all(0));
}

static void advance(void *state, long steps) {
  elastic_fcc *h = state;
  const int rows_here = h->problem->lattice->row_count;
  for (long step = 0; step < steps; step++)
    for (int row = 0; row < rows_here + h->reach; row++) {
      for (int k = 0; k < DIRECTIONS && row < rows_here; k++)
        find_bonds(h, row, k);
      if (row < h->reach) continue;
      for (int k = 0; k < DIRECTIONS; k++)
        find_forces(h, row - h->reach, k);
      move_row(h, row - h->reach);
    }
}

/* --- set-up ----------------------------------------------------------------------------------- */

static void set_law(elastic_fcc *h) {
  const family_problem *p = h->problem;
  const rows *g = p->lattice;
  const double s = g->spacing, kick = p->time_step * p->time_step / (g->mass * s);
  const double a = kick * p->E * s * s / (sqrt(2) * (1 + p->nu)),
               second = a * (1 / (2 * sqrt(2)) - 1);
  const double b = kick * (3 - 3 / sqrt(2)) * (sqrt(2) - 1) * p->E * s * s * (1 - 4 * p->nu) /
                   (24 * (2 * p->nu - 1) * (1 + p->nu));
  for (int k = 0; k < DIRECTIONS; k++) {
    const double length = g->length[k] / s;
    h->square[k] = 1 / (length * length);
    h->weight[k] = length * b / 2;
    h->stiffness[k] = g->shell[k] == 2 ? a + second : a;
    for (int d = 0; d < 3; d++) {
      h->chord[k][d] = g->chord[k][d] / s;
      h->growth[k][d] = 2 * h->chord[k][d] * h->square[k];
    }
    for (int row = 0; row < g->row_count; row++)
      while (rows_offset(g, row, k) > h->reach * g->pitch)
        h->reach++;
  }
}

static void *start(const family_problem *p) {
  const rows *g = p->lattice;
  elastic_fcc *h = must_calloc(1, sizeof *h);
  h->problem = p;
  set_law(h);
  h->ring_rows = h->reach + 1;
  h->ring = lanes_zeros((long)h->ring_rows * DIRECTIONS * 2 * g->pitch);
  double **const arrays[] = {&h->u[0], &h->u[1],     &h->u[2],     &h->v[0],     &h->v[1],
                             &h->v[2], &h->force[0], &h->force[1], &h->force[2], &h->sum};
  lanes_share(arrays, sizeof arrays / sizeof *arrays, g->size);
  return h;
}

static void end(void *state) {
  elastic_fcc *h = state;
  free(h->u[0]); /* with all that share its memory */
  free(h->ring);
  free(h);
}

static void set(void *state, const motions *from) {
  const elastic_fcc *h = state;
  motions_scale(h->u, h->v, from, h->problem);
}

static void get(const void *state, motions *to) {
  const elastic_fcc *h = state;
  motions_unscale(to, h->u, h->v, h->problem);
}

const body_program HANDWRITTEN_NAME(elastic_fcc) = {start, end, set, get, advance};
