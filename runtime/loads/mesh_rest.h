/* A mesh at rest under its loads: in each increment of a static run what supports, drives, forces
   and weight prescribe at its end, the displacements that K u = F gives then, reactions, and the
   work that was done, of which a linear law stores all.

   Where laws have a stress without strain (pl_law.affine), the points push, too: with f the forces
   of the points where the last increment has left them, and what laws are given now,
   K du = F + f, which is exact as K is the same at all strains. Between two increments the rest
   state goes on evenly; so what it gives is the mean of what stored energy would change by at
   either place. What was out of balance at the start is let go at the first increment: it does half
   of its work on the way, which is taken as by damping. */
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

/* The increment of that clock begins, from the state observed last. */
void mesh_rest_begin(mesh_rest *r, load_clock clock);
/* Whether points push: then the same places are to be observed at the new time, and that is to be
   told (mesh_rest_see_given) before it is solved. */
bool mesh_rest_is_pushed(const mesh_rest *r);
/* The body takes its places at the end of the increment. Returns the largest force that is left
   unbalanced, over the largest force or reaction. */
double mesh_rest_solve(mesh_rest *r);
/* What the rest state is seen to give at the places observed; `last`: these are the new ones. */
void mesh_rest_see_given(mesh_rest *r, bool last);
/* J, for checkpoints: by rest states since the start; the most that displacements of an increment
   store, by which rounding is measured. */
typedef struct mesh_rest_account {
  double given, turned;
} mesh_rest_account;
mesh_rest_account *mesh_rest_sum(mesh_rest *r);
/* When forces and reactions there have been observed: the work of all loads since the last time. */
void mesh_rest_work(mesh_rest *r);

#endif
