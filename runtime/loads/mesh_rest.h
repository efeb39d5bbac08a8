/* A mesh at rest under its loads: in each increment of a static run what supports, drives, forces
   and weight prescribe at its end, the displacements that K u = F gives then, reactions, and the
   work that was done, of which a linear law stores all. */
#ifndef PERILAT_RUNTIME_MESH_REST_H
#define PERILAT_RUNTIME_MESH_REST_H

#include "dsl/base/diagnostics.h"
#include "runtime/continuum/cells.h"
#include "runtime/loads/load_steps.h"

typedef struct mesh_rest mesh_rest;

/* All must outlive it. */
mesh_rest *mesh_rest_new(const cells *c, loads *l, body *w);
void mesh_rest_free(mesh_rest *r);

/* Whether the mesh, called `name`, is held in all increments of `interval` (s), and pins on
   element-free nodes are without reaction. False with a diagnostic at `where`. */
bool mesh_rest_check(mesh_rest *r, const char *name, span where, int increments, double interval,
                     diagnostics *d);

/* The increment of that clock: the body takes its places. Returns the largest force that is left
   unbalanced, over the largest force or reaction. */
double mesh_rest_solve(mesh_rest *r, load_clock clock);
/* When forces and reactions there have been observed: the work of all loads since the last time. */
void mesh_rest_work(mesh_rest *r);

#endif
