/* The rest state of a bond: what a law calls `stretch` is measured from its `rest stretch`. Lowered
   laws, their derivatives and energies have that as their input; bodies know the change of length
   over the reference length, which is put in its place here. */
#ifndef PERILAT_GENERATOR_LOWER_REST_H
#define PERILAT_GENERATOR_LOWER_REST_H

#include "generator/lower/lowered.h"

/* In `count` nodes that were made of the lowered law. */
void rest_take_off(ir *g, const lowered_law *of, ir_node *nodes, int count);
/* In all that the law gives: forces, energy, new fields, outputs. */
void rest_take_off_law(ir *g, const law *l, lowered_law *of);
/* The same with a stand-in for the rest stretch, which may then be that of other states than the
   rest of the node. */
void rest_hold(ir *g, const law *l, const lowered_law *of, ir_node *node);
ir_node rest_stand_in(ir *g, const law *l);
ir_node rest_filled_in(ir *g, const law *l, ir_node rest, ir_node node);
/* Whether the rest state [rests] follows states, and so changes with time. */
bool rest_reads_states(ir *g, const law *l, const ir_node *rest, int rests);

#endif
