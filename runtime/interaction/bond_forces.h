/* The force of each bond, by itself. Engines add the forces of bonds up and forget them; stresses
   and sections need them one by one, now and then. They are found aside, from the places, the
   velocities and the fields that the last step has left, as those that are observed (sweep.h):
   their sums are the forces of the state observed, to rounding.

   Of several laws at work together (joint.h) a bond comes once for each that has a part in it.

   Of laws of bonds the law is asked strip by strip. The bonds of a law of families
   (family_forces.h) may depend on their families, and only the last pass of a step knows forces: it
   is run once more for every direction, twice, with bonds of which no two meet in a particle. */
#ifndef PERILAT_RUNTIME_BOND_FORCES_H
#define PERILAT_RUNTIME_BOND_FORCES_H

#include "runtime/interaction/sweep.h"

typedef struct bond_force {
  long owner, partner; /* sites */
  int direction;       /* of the bond at its owner */
  /* [dof] N, N m: what the bond exerts on its ends */
  double on_owner[PL_MAX_DOF], on_partner[PL_MAX_DOF];
} bond_force;

typedef void bond_force_use(void *to, const bond_force *bond);

typedef struct bond_forces bond_forces;

/* Part of its memory is the body's. One thread at a time; to be freed before the sweep. */
bond_forces *bond_forces_new(sweep *w);
void bond_forces_free(bond_forces *f);
/* The forces are those of the present state from now on, until a particle moves. Nothing is done
   where they were found at that step; -1: whatever was found. */
void bond_forces_find(bond_forces *f, int64_t step);
/* Every bond that exists and is wanted, in an order that threads do not change. `wanted`: [size]
   bits of the bonds that sites own; NULL: all. */
void bond_forces_each(bond_forces *f, const uint64_t *wanted, bond_force_use *use, void *to);

#endif
