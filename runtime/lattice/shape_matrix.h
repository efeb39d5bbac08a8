/* Shape matrices of the particles' families: what fits a strain to the stretches of the bonds that
   exist in the reference state. With n = (x^2, y^2, x y) or (x^2, y^2, z^2, x y, y z, x z) of a
   bond's reference direction, the inverse of sum(n n^T), on lists of sum(s n n^T) with the bonds'
   lengths s. Where the bonds do not fix all strains (corners, slits) it is the pseudo-inverse that
   gives the smallest of the strain tensors that fit, whatever the axes: eigenvalues below 1e-9 of
   the largest, on lists below 1e-3 of it, count as 0. A family resolves all strains when the
   smallest eigenvalue is at least 1e-3 of the largest. */
#ifndef PERILAT_RUNTIME_SHAPE_MATRIX_H
#define PERILAT_RUNTIME_SHAPE_MATRIX_H

#include "runtime/lattice/rows.h"

/* matrix[PL_SHAPE_PLANES][size]: upper triangles row by row, then 1 where the family resolves all
   strains, else 0. Set at the particles. */
void shape_matrices(const rows *w, double *const *matrix);

/* The same of a particle of a lattice whose neighbours are all there: values[PL_SHAPE_PLANES]. */
void shape_matrix_full(const rows *w, double *values);

/* Particles of a list whose families do not resolve all strains. resolved[particle_count] (may be
   NULL) becomes 0 for these, 1 for the others. */
long shape_unresolved(const rows *w, int32_t *resolved);

#endif
