/* Force constants of the virgin infinite lattice of a law of families, from the law's own step: in
   a small periodic lattice one particle is displaced, or moved, a little, and the forces on all
   others are read. The force on a particle is f(0) = - sum over R of K(R) u(R) + C(R) v(R); R
   reaches as many chords far as the step has passes. Rotations stand for ways, spacing times
   angle, and moments for forces, over the spacing: all constants are N/m or N s/m. */
#ifndef PERILAT_RUNTIME_STENCIL_H
#define PERILAT_RUNTIME_STENCIL_H

#include "runtime/analysis/waves.h"

typedef struct stencil_block {
  long cell[3];         /* R in primitive vectors */
  double R[3];          /* m */
  wave_block stiffness; /* N/m */
  wave_block damping;   /* N s/m */
} stencil_block;

typedef struct stencil {
  int dimensions, dof, count;
  stencil_block *blocks; /* [count] that of R = 0, then R and -R by turns */
  bool finite;
  double imbalance; /* |sum of K(R)| before it was taken from K(0), over |K(0)|, but for moments by
                       rotations: who moves along with all others must feel nothing */
  /* Part by which one side of a kink at rest is stiffer than the mean of both, which the blocks
     have. */
  double kink;
} stencil;

/* What geometry and rounding leave of it is less. */
#define STENCIL_KINK 1e-5

/* K(R) and K(-R) are made each other's transpose: laws whose virgin forces have a stored energy
   give them so. */
stencil stencil_new(const pl_law *law, const double *parameters, const rows *w);
void stencil_free(stencil *s);

/* For waves; w->mass must be set. Where there is a kink at rest, the stiffness is that of its
   stiffer side. Damping that shortens no step (of 1e-12 of the critical one) is left out. */
crystal stencil_crystal(const pl_law *law, const double *parameters, const rows *w);

/* Elastic constants by the method of long waves (Born and Huang 1954, section 26), rotations in
   balance: Pa, in the order xx, yy, xy or xx, yy, zz, xy, yz, xz, shear strains as angles, row by
   row. */
void stencil_elastic(const stencil *s, const rows *w, double *D);

#endif
