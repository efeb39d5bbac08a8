/* What is said of an operation that may not be defined: where it stands, and a state that shows
   it. */
#ifndef PERILAT_GENERATOR_INTERVAL_WARNING_H
#define PERILAT_GENERATOR_INTERVAL_WARNING_H

#include "generator/intervals/interval_context.h"
#include "generator/intervals/interval_witness.h"

/* Warns that `operand` of node n can be what is wished, where a state shows it. */
void interval_warn(analysis *a, context *c, ir_node n, ir_node operand, interval_wish wish);
/* A function called many times is one place. */
bool interval_said_before(const analysis *a, diag_code code, span where);

#endif
