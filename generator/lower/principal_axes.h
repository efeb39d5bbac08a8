/* Principal directions of symmetric tensors, each as the dyad n n of its unit vector, which has no
   sign. */
#ifndef PERILAT_GENERATOR_PRINCIPAL_AXES_H
#define PERILAT_GENERATOR_PRINCIPAL_AXES_H

#include "generator/lower/lowering.h"

/* Of the principal value `which` of 1, 2, 3, the largest first. The three are at right angles, and
   where values are equal they are some of the many that there are. */
components tensor_direction(ir *g, components a, int which);
/* (a b + b a)/2 */
components tensor_product(ir *g, components a, components b);

#endif
