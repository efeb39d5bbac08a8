/* What a law and a set of particles that stand anywhere make of what is exact on a lattice: families that do not resolve all
   strains, forces that uniform strain leaves inside, forces that do not add up to 0. Found before a run, from the law's own
   step in the virgin state. */
#ifndef PERILAT_RUNTIME_RESIDUALS_H
#define PERILAT_RUNTIME_RESIDUALS_H

#include "runtime/sweep.h"

typedef struct residuals {
  int fewest, most; /* bonds of a particle */
  double mean;
  long unresolved; /* particles whose family does not resolve all strains (shape_matrix.h) */
  double
      patch; /* root mean square force on particles inside, over that on particles at the surface, in uniform strains;
                        NaN where there is no inside or no force */
  double
      unbalanced; /* largest component of the sum of all forces over the sum of their sizes, in displacements at random */
} residuals;

/* Of a sweep on a list that has not begun: it is left as it was, but for its forces. */
residuals residuals_find(sweep *w);

/* inside[particle_count]: 1 for particles that are not at the surface, and none of whose neighbours is. At the surface the
   family lies to one side: |sum of chords| is more than 0.35 of the sum of their lengths. */
void residuals_inside(const rows *w, unsigned char *inside);

#endif
