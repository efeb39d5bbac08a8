/* Names, numbers, units and expressions of a law as LaTeX formulas. */
#ifndef PERILAT_DSL_EXPLAIN_MATH_H
#define PERILAT_DSL_EXPLAIN_MATH_H

#include <stdio.h>

#include "dsl/semantics/law.h"

/* Step a state or damage is taken at. */
/* STEP_FLOWING: while a returned flow is solved for. */
typedef enum step_index { NO_STEP, STEP_OLD, STEP_NEW, STEP_FLOWING } step_index;

/* A symbol with step and, when `indexed`, neighbour: \omega^{(n-1)}, x_{j}. */
void math_symbol(const law *l, const char *name, step_index step, bool indexed, bool primed,
                 FILE *out);
void math_expr(const law *l, const expr *e, FILE *out);
/* "kg/m^3" as \mathrm{kg}/\mathrm{m}^{3}. */
void math_unit(const char *unit_text, FILE *out);

/* Is it a name whose value depends on the step? */
bool math_has_step(const symbol *s);

#endif
