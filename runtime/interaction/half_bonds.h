/* Bonds that a body has not, but stands for by halves: those of a lattice along the edge of a mesh
   that it is tied to (mesh_ties.h), whose other half the mesh is. Their law is the lattice's with
   half of the thickness, and half of the masses. They do not break: each is as if it was new. */
#ifndef PERILAT_RUNTIME_HALF_BONDS_H
#define PERILAT_RUNTIME_HALF_BONDS_H

#include "runtime/interaction/sweep.h"

typedef struct half_bond {
  int64_t site; /* that owns it */
  int direction;
  int32_t end[2]; /* numbers of its ends, for forces */
} half_bond;

typedef struct half_bonds half_bonds;

/* Of a law of bonds on rows at work on the body; `bonds` [count] are copied. */
half_bonds *half_bonds_new(const sweep *w, const double *parameters, const half_bond *bonds,
                           long count);
void half_bonds_free(half_bonds *h);

/* Finds forces and moments of the present state; `stepped`: what rate terms took in the state
   before is booked, as a step has been done since. */
void half_bonds_find(half_bonds *h, bool stepped);
/* Adds those found (N, N m) to force[dof][number of the end]. */
void half_bonds_add(const half_bonds *h, double *const force[PL_MAX_DOF]);

/* J: stored in the state found; taken by rate terms up to it. */
double half_bonds_stored(half_bonds *h);
double half_bonds_taken(const half_bonds *h);
/* The same that their rest states, and fields that change, have given. */
double half_bonds_given(const half_bonds *h);
/* J: taken up to the last step, for checkpoints. */
double *half_bonds_booked(half_bonds *h);

#endif
