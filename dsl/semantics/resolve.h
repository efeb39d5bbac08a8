/* Expressions with some of the law's options decided: case lines that are then never chosen, and
   conditions that then always hold, fall away. For readers; the compiler decides options where it
   lowers comparisons. */
#ifndef PERILAT_DSL_RESOLVE_H
#define PERILAT_DSL_RESOLVE_H

#include "dsl/semantics/law.h"

/* `e` itself where no choice matters, else a copy in the law's memory of what changes. */
const expr *resolve_options(const law *l, const expr *e, const law_choice *choices, int count);

#endif
