/* Whether a point keeps its ellipticity: whether waves of all directions run.

       A(n) = n.D.n       acoustic tensor of a direction n, D the tangent
       m.A(n).m > 0       for all n and m (strong ellipticity)

   Where the smallest eigenvalue of A's symmetric part over all n comes to 0, strain may gather in a
   band across n, in which the motion jumps along m: m along n opens it, m across n shears it. */
#ifndef PERILAT_GENERATOR_ELLIPTICITY_H
#define PERILAT_GENERATOR_ELLIPTICITY_H

#include "runtime/kernel.h"

typedef struct ellipticity {
  double least;               /* Pa: that eigenvalue */
  double normal[3], along[3]; /* n and m, of length 1 */
} ellipticity;

/* The tangent is one of pl_points: by strains whose shears are those of engineers. */
ellipticity ellipticity_of(int dimensions, const double tangent[PL_MAX_STRAINS][PL_MAX_STRAINS]);

#endif
