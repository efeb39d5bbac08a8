/* The non-local gradient of a family and the force state that is its counterpart (Silling, Epton,
   Weckner, Xu, Askari 2007, shape tensor and correspondence model): with the reference bonds X_j,
   their weights w_j (IR_NONE: 1), the volumes V_j and the shape tensor K = sum(w_j V_j X_j X_j),

       gradient(a)       = sum(w_j V_j (a_j - a) X_j) K^-1
       correspondence(P) = 2 V V_j w_j P K^-1 X_j             N

   The gradient of what is linear in place is exact in every family that resolves it. One whose
   bonds hardly leave a line, or in space a plane, resolves none, and its K^-1 is taken as 0: where
   det K is below 1e-3 of what it would be for the same trace and equal principal values. */
#ifndef PERILAT_GENERATOR_LOWER_GRADIENT_H
#define PERILAT_GENERATOR_LOWER_GRADIENT_H

#include "generator/lower/lowering.h"

/* `u`, m: inputs of loops over bonds. */
components lower_displacement(ir *g, const law *l);
/* Of a number a vector, of a vector a general tensor: row by row the gradients of its
   components. */
components lower_gradient(ir *g, const law *l, components value, ir_node weight);
/* The force state, a vector toward each neighbour, of a stress P in Pa. */
components lower_correspondence(ir *g, const law *l, components P, ir_node weight);

#endif
