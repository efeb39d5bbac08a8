/* What the other end of a bond has for a value: computed again from what the ends exchange, or read
   from a link that its own particle has left in an earlier pass. */
#ifndef PERILAT_GENERATOR_PROGRAM_MIRROR_H
#define PERILAT_GENERATOR_PROGRAM_MIRROR_H

#include "generator/plan/program_builder.h"

/* The value without IR_NEIGHBOUR. */
ir_node program_resolve(builder *b, ir_node n);
/* What the neighbour has for a resolved value. */
ir_node program_mirror(builder *b, ir_node n);

/* Whether the particle leaves the value to its neighbours: they cannot compute it, or it is linked
   since they need not. */
bool program_is_left(builder *b, ir_node n);
/* The link that holds a value, as the neighbour at the other end reads it, and as its own particle
   does; what the link that an input reads from
   the neighbour holds. */
ir_node program_neighbour_link(builder *b, ir_node n);
ir_node program_own_link(builder *b, ir_node n);
ir_node program_linked_node(const builder *b, ir_node input);

/* Whether the value goes over a family, so that a neighbour cannot compute it again. */
bool program_goes_over_family(builder *b, ir_node n);

/* What a value toward a neighbour costs when it is computed again (no more than `most` is counted),
   in additions. */
int program_cost_again(const ir *g, ir_node n, int most);

/* The same operation of other operands, with the name of the first. */
ir_node program_made_again(ir *g, ir_node n, const ir_node *operand);

/* Puts to[k] in place of from[k] in the roots and in what links hold. */
void program_substitute(builder *b, segment *wanted, const ir_node *from, const ir_node *to,
                        int pair_count);

#endif
