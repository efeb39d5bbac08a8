/* A plan behind the interface of a compiled kernel, on the interpreter. */
#ifndef PERILAT_GENERATOR_INTERPRETED_H
#define PERILAT_GENERATOR_INTERPRETED_H

#include "generator/ir/interpret.h"
#include "generator/plan/plan.h"

/* The plan on the interpreter, behind the same interface as a compiled kernel, for any number of
   threads. The plan must outlive it. */
pl_law *plan_interpreted(const kernel_plan *p);
void plan_interpreted_free(pl_law *law);
/* interpreter_watch of all that it evaluates; the caller's threads call `look`. */
void plan_interpreted_watch(const pl_law *law, interpreter_look *look, void *context);
const kernel_plan *plan_of_interpreted(const pl_law *law);

#endif
