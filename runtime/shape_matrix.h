/* Shape matrices of the particles' families: what fits a strain to the stretches of the bonds that
   exist in the reference state. With n = (x^2, y^2, x y) or (x^2, y^2, z^2, x y, y z, x z) of a bond's reference
   direction, the inverse of sum(n n^T); where the bonds do not fix all strains (corners, slits) the
   pseudo-inverse that gives the smallest of the strain tensors that fit, whatever the axes: eigenvalues below 1e-9 of the
   largest count as 0. */
#ifndef PERILAT_RUNTIME_SHAPE_MATRIX_H
#define PERILAT_RUNTIME_SHAPE_MATRIX_H

#include "runtime/rows.h"

/* matrix[PL_SHAPE_VALUES][size]: upper triangles row by row, set at the particles. */
void shape_matrices(const rows *w, double *const *matrix);

/* The matrix of a particle whose neighbours are all there: values[PL_SHAPE_VALUES]. */
void shape_matrix_full(const rows *w, double *values);

#endif
