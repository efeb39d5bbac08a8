/* The room from tree to law: every name is resolved, units and shapes agree, every value has its
   place; all that is wrong is said, each slip once. Here it is led, in this order:

     declarations   each statement enters its names, so that all are known before one is read
     names          what an expression reads: a quantity of the law, a built-in one, an option
     types          each expression, in the order written: its unit, shape and place
     calls            those of functions; the body of the law's own is checked anew at each call
     agreement        when two values agree, and what is said when they do not
     order            a name that is read above its definition: out of order, or a cycle
     parameters     defaults and bounds
     order          what no force and no output needs

   Example:
     parameter k = 2 [MN]           k: N, a scalar of the body
     state top = 0                  a bare 0 has any unit: a first round, which says nothing, finds
     top = max(top, stretch)          1 in this rule; the `top` in it is that of the last step
     force N = k*(top + s)          `top` is a pure number, `s` a length: reported, and N is broken:
                                      no message follows for what reads it */
#ifndef PERILAT_DSL_LAW_CHECK_H
#define PERILAT_DSL_LAW_CHECK_H

#include "dsl/semantics/law.h"

C_LINKAGE_BEGIN

/* Checks names, units, placement, definite assignment, options. All errors of the file are
   reported. `choices` selects options (NULL, 0: the first of each). Returns NULL when there are
   errors. What cannot be compiled is no error here: the generator says so. */
law *law_check(arena *memory, tree *t, const source_set *sources, const law_choice *choices,
               int choice_count, diagnostics *d);

C_LINKAGE_END

#endif
