/* From a tree to a law: leads the checks of names, units, places and order. */
#ifndef PERILAT_DSL_LAW_CHECK_H
#define PERILAT_DSL_LAW_CHECK_H

#include "dsl/semantics/law.h"

C_LINKAGE_BEGIN

/* Checks names, units, placement, definite assignment, options. All errors of the file are reported.
   `choices` selects options (NULL, 0: the first of each). Returns NULL when there are errors.
   What cannot be compiled is no error here: the generator says so. */
law *law_check(arena *memory, tree *t, const source_set *sources, const law_choice *choices,
               int choice_count, diagnostics *d);

C_LINKAGE_END

#endif
