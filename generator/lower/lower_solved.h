/* Rules that are solved for a state, as flows that return and rates are: what stays as it is while
   that is done, and how a rule says that nothing was found. */
#ifndef PERILAT_GENERATOR_LOWER_SOLVED_H
#define PERILAT_GENERATOR_LOWER_SOLVED_H

#include "generator/lower/lowering.h"

/* What neighbours have, each behind an input of its own, so that it stays as it is. Returns how
   many. */
int lower_freeze_neighbours(lowering *c, ir_node *n, ir_node **what, ir_node **stand_in);
/* Whether a sum over the family moves with the input. */
bool lower_moves_a_sum(const ir *g, ir_node over, ir_node input);
/* 0 where the condition holds, else no number: so that what is made of it is found, and told. */
ir_node lower_zero_if(ir *g, ir_node good);

#endif
