/* Expressions of a law's text as nodes. */
#ifndef PERILAT_GENERATOR_LOWER_VALUE_H
#define PERILAT_GENERATOR_LOWER_VALUE_H

#include "generator/lower/lowering.h"

components lower_value(lowering *c, const expr *e);
/* The same where one number is expected. */
ir_node lower_expr(lowering *c, const expr *e);

#endif
