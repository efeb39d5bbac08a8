/* What acts at a point of a mesh: bilinear functions in a finite element, moving least squares in
   an element-free cell, in an interface cell both, blended by R, the sum of the bilinear functions
   of its element-free corners (Belytschko, Organ and Krongauz 1995; Karlsson 2006, 2.5 with the
   indices of 2.51 corrected):

       N = (1 - R) N_bilinear + R N_moving
       N_,i = -R_,i N_bilinear + (1 - R) N_bilinear,i + R_,i N_moving + R N_moving,i

   They sum to 1, reproduce linear fields, and agree on both sides of every edge. */
#ifndef PERILAT_RUNTIME_SHAPE_FUNCTIONS_H
#define PERILAT_RUNTIME_SHAPE_FUNCTIONS_H

#include "runtime/mesh/moving_least_squares.h"

/* At a point of cell `cell`, which must hold it. False as moving_least_squares. */
bool shape_functions(const mesh *m, int cell, const double at[2], point_shape *out);

#endif
