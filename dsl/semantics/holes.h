/* What is still to be written: the holes `?` of a law, each with what it must be, as far as the
   rest of the law tells. */
#ifndef PERILAT_DSL_HOLES_H
#define PERILAT_DSL_HOLES_H

#include "dsl/semantics/checker.h"

/* After all else has been checked: one error a hole, in the order written. */
void report_holes(checker *ck);

#endif
