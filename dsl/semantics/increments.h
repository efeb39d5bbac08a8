/* What a rule reads as 0 by where it stands: the increment of a state, x - previous(x), is there
   only below the rule of x, in the yield function that x is returned by, and in its rate. */
#ifndef PERILAT_DSL_INCREMENTS_H
#define PERILAT_DSL_INCREMENTS_H

#include "dsl/semantics/checker.h"

/* Warns of increments that are always 0, and of names made of one that stand above the rule of the
   state and are used beside its yield function or its rate. For laws without errors. */
void report_increments(checker *ck);

#endif
