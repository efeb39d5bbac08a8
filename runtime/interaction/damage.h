/* Damage of bonds and particles in the state observed, from the law's fields of that kind, wherever
   they stand. A bond's damage is the largest of those on it (laws of families: of their means over
   both sides). A particle's is the largest of those on it; where the law has none there, the mean
   over the bonds that it began with. */
#ifndef PERILAT_RUNTIME_DAMAGE_H
#define PERILAT_RUNTIME_DAMAGE_H

#include "runtime/interaction/sweep.h"

/* Whether the law has damage on bonds (or on neighbours), on particles (or on points: at nodes
   their mean). */
bool damage_on_bonds(const pl_law *law);
bool damage_on_particles(const pl_law *law);
/* On either. */
bool damage_on_any(const pl_law *law);

/* 0 without. `field`: those of a state, [law's fields]. */
double damage_of_bond(const sweep *w, const rows_bond *bond);
double damage_of_bond_in(const sweep *w, double *const *field, const rows_bond *bond);
/* [directions][size] that of every bond, at its owner, where one damage is all and the same from
   either end; NULL otherwise. */
const double *damage_of_all_bonds(const sweep *w);
const double *damage_of_all_bonds_in(const sweep *w, double *const *field);
/* Of those on particles; 0 without. */
double damage_of_site(const sweep *w, long site);
double damage_of_site_in(const sweep *w, double *const *field, long site);
/* A law at work on the particles, with the bonds it has a part in. */
typedef struct damage_law {
  const sweep *of;
  const rows_bond *bonds;
  long bond_count;
} damage_law;
/* values[particle_count]: of all laws at work on a body. */
void damage_of_particles(const damage_law *laws, int count, double *values);

#endif
