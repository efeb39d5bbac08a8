/* The range of every value of a law, case by case; warns of operations that are not defined
   within them. */
#ifndef PERILAT_GENERATOR_INTERVAL_RANGES_H
#define PERILAT_GENERATOR_INTERVAL_RANGES_H

#include "generator/intervals/interval_context.h"

/* Of a node in a branch; found once. */
range interval_value(analysis *a, context *c, ir_node n);

#endif
