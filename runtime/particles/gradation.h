/* How large particles are to be where: one spacing for all, or a formula of the place in bounds
   that neighbours bear. Lengths in m. */
#ifndef PERILAT_RUNTIME_GRADATION_H
#define PERILAT_RUNTIME_GRADATION_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/particles/solid.h"

#define GRADATION_MOST_RATIO 4.0 /* of the largest to the smallest spacing in a body */
/* Of the spacing over the distance: in one strain the stress scatters over the particles by half as
   much again there as among particles of one size (tests/verification/test_graded.c). */
#define GRADATION_MOST_SLOPE 0.25

typedef struct gradation {
  int dimensions;
  double spacing;               /* of all particles, or without a meaning */
  const struct formula *graded; /* of x, y, z; NULL: the spacing is the same everywhere */
  double least, most;           /* of the spacing, as far as looked at */
  double count;                 /* of particles in the solid */
} gradation;

/* m^2 or m^3 that a site of the hexagonal or fcc lattice of that spacing stands for. */
double particle_measure(int dimensions, double spacing);

/* Looks through the solid: `least`, `most` and `count`, the integral of one particle over
   its share. False with diagnostics at the deck's `spacing`: no positive value somewhere, a larger
   ratio than GRADATION_MOST_RATIO, more particles than can be stored. */
bool gradation_begin(gradation *g, const deck_lattice *l, const solid *s, double size,
                     diagnostics *d);

/* The spacing at a place; what the formula says there where that has no meaning, too. */
double gradation_at(const gradation *g, const double at[3]);
/* Its slope by differences over a `reach` on either side; 0 where the formula has no value. */
void gradation_slope(const gradation *g, const double at[3], double reach, double slope[3]);

/* Of particles at these places, own[count] becomes their spacing: again in bounds, and no slope
   steeper than GRADATION_MOST_SLOPE. True where the spacing is the same everywhere. */
bool gradation_is_borne(gradation *g, const deck_lattice *l, double *const at[3], double *own,
                        long count, diagnostics *d);

#endif
