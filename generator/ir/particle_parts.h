/* A value of a bond as a sum of products, each of what is the particle's and of what is the same at
   both ends: the particle computes its part once, and the sum over both ends is that of the
   parts. */
#ifndef PERILAT_GENERATOR_PARTICLE_PARTS_H
#define PERILAT_GENERATOR_PARTICLE_PARTS_H

#include "generator/ir/ir.h"

/* value + IR_NEIGHBOUR(value), taken apart where that can be done with few parts, up to rounding.
   same[same_count]: values known to be the same at both ends, whatever they are made of. */
ir_node particle_parts_of_both(ir *g, ir_node value, const ir_node *same, int same_count);

#endif
