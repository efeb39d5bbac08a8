/* Derivatives of values, as values of the same graph. */
#ifndef PERILAT_GENERATOR_DERIVE_H
#define PERILAT_GENERATOR_DERIVE_H

#include "generator/ir/ir.h"

/* Symbolic derivative of f by the node x (an input, or any node taken as independent), in time
   linear in the graph. Kinks: sign(0) = 0 for abs; min and max take the derivative of the side they
   choose, the second where both are equal; a case keeps its guards; sqrt(u) at 0 takes 0 where u
   does not change. Every operation has one. */
ir_node ir_derivative(ir *g, ir_node f, ir_node x);

#endif
