/* Meshes and laws that several tests of continua share. */
#ifndef PERILAT_TESTS_MESH_CASES_H
#define PERILAT_TESTS_MESH_CASES_H

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/continuum/line_load.h"
#include "runtime/continuum/node_stencil.h"

/* Isotropic, in plane stress or strain. */
static inline plane_stiffness isotropic(double E, double nu, bool strain) {
  if (strain) {
    E /= 1 - nu * nu;
    nu /= 1 - nu;
  }
  const double a = E / (1 - nu * nu);
  return (plane_stiffness){{{a, nu * a, 0}, {nu * a, a, 0}, {0, 0, E / (2 * (1 + nu))}}};
}

/* A mesh with everything that a static solution needs. */
typedef struct case_mesh {
  mesh m;
  integration_points points;
  plane_stiffness law;
  node_stencil K;
  unsigned char *held;
  double *u[2], *force[2], *reaction[2];
} case_mesh;

static inline void case_settle(case_mesh *c) {
  const size_t nodes = (size_t)mesh_node_count(&c->m);
  mesh_settle(&c->m);
  integration_points_open(&c->points, &c->m);
  node_stencil_open(&c->K, &c->m, &c->points, &c->law, NULL);
  c->held = must_calloc(2 * nodes, 1);
  for (int d = 0; d < 2; d++) {
    c->u[d] = must_calloc(nodes, sizeof(double));
    c->force[d] = must_calloc(nodes, sizeof(double));
    c->reaction[d] = must_calloc(nodes, sizeof(double));
  }
}

static inline void case_close(case_mesh *c) {
  node_stencil_close(&c->K);
  integration_points_close(&c->points);
  mesh_close(&c->m);
  free(c->held);
  for (int d = 0; d < 2; d++) {
    free(c->u[d]);
    free(c->force[d]);
    free(c->reaction[d]);
  }
}

static inline void constant_traction(void *context, const double at[2], double traction[2]) {
  (void)at;
  memcpy(traction, context, 2 * sizeof *traction);
}

#endif
