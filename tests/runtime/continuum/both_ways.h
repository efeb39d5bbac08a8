/* A mesh whose forces are found by the assembled stencil and by points of integration. */
#ifndef PERILAT_TESTS_BOTH_WAYS_H
#define PERILAT_TESTS_BOTH_WAYS_H

#include <math.h>

#include "mesh_cases.h"
#include "runtime/base/random_number.h"
#include "runtime/continuum/point_forces.h"

typedef struct both {
  mesh m;
  integration_points points;
  plane_stiffness law;
  node_stencil K;
  point_forces *P;
  pool *memory;
  double *u[2], *by_stencil[2], *by_points[2];
} both;

/* The mesh stands. `of` with these values has that stiffness. */
static inline void both_open(both *b, plane_stiffness stiffness, const pl_law *of,
                             const double *values) {
  integration_points_open(&b->points, &b->m);
  b->law = stiffness;
  node_stencil_open(&b->K, &b->m, &b->points, &b->law, NULL);
  node_stencil_resist_hourglass(&b->K);
  b->P = point_forces_new(&b->m, NULL, &b->points, of, values, 1, true);
  b->memory = pool_new();
  for (int d = 0; d < 2; d++) {
    b->u[d] = pool_doubles(b->memory, b->K.layout.size);
    b->by_stencil[d] = pool_doubles(b->memory, b->K.layout.size);
    b->by_points[d] = pool_doubles(b->memory, b->K.layout.size);
  }
}

static inline void both_close(both *b) {
  point_forces_free(b->P);
  node_stencil_close(&b->K);
  integration_points_close(&b->points);
  mesh_close(&b->m);
  pool_free(b->memory);
}

/* `seen`: energies of the points, too, and no new states. */
static inline void both_find(both *b, bool seen) {
  const double *const u[2] = {b->u[0], b->u[1]};
  const point_motion at = {u, u, 0, 1, 0};
  node_stencil_multiply(&b->K, u, b->by_stencil, 0, b->m.nodes[1]);
  point_forces_find(b->P, 0, 0, b->m.nodes[1], &at, seen, b->by_points);
  for (int row = 0; row < b->m.nodes[1]; row++)
    point_forces_take(b->P, row, false, b->by_points);
}

static inline void both_move(both *b) {
  for (int n = 0; n < mesh_node_count(&b->m); n++)
    for (int d = 0; d < 2; d++)
      b->u[d][node_layout_at(&b->K.layout, n)] =
          1e-4 * (random_unit(random_mix((uint64_t)(2 * n + d))) - 0.5);
}

/* Largest difference of the forces, and the largest force. */
static inline double both_differ(const both *b, double *largest) {
  double most = 0;
  *largest = 0;
  for (int n = 0; n < mesh_node_count(&b->m); n++)
    for (int d = 0; d < 2; d++) {
      const long at = node_layout_at(&b->K.layout, n);
      most = fmax(most, fabs(b->by_points[d][at] - b->by_stencil[d][at]));
      *largest = fmax(*largest, fabs(b->by_stencil[d][at]));
    }
  return most;
}

#endif
