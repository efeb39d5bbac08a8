/* What depends on what: cycles, and names that reach no force and no output. */
#ifndef PERILAT_DSL_ORDER_H
#define PERILAT_DSL_ORDER_H

#include "dsl/semantics/checker.h"

/* Reports that `e` names something defined only below; as a cycle when that something needs what is
   being defined. */
void report_undefined(checker *ck, const expr *e, entry *target);
/* Sets expr.goes_on of the names of states in their own rates and in what these read. */
void mark_going_on(checker *ck);
/* Sets symbol.used of all that a force or an output reaches. */
void mark_used(checker *ck);
/* An error for each damage without effect, warnings for the rest. */
void report_unused(checker *ck);

#endif
