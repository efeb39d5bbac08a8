/* A plan behind the interface of a compiled kernel, on the interpreter. */
#ifndef PERILAT_GENERATOR_INTERPRETED_H
#define PERILAT_GENERATOR_INTERPRETED_H

#include "generator/plan/plan.h"

/* The plan on the interpreter, behind the same interface as a compiled kernel, for any number of
   threads. The plan must outlive it. */
pl_law *plan_interpreted(const kernel_plan *p);
void plan_interpreted_free(pl_law *law);

#endif
