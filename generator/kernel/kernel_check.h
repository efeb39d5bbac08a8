/* A compiled kernel against the interpreter, on random states and random strips that reach every
   case of the law. Both read one graph with the same operations in the same order, so their bits
   must agree. */
#ifndef PERILAT_GENERATOR_KERNEL_CHECK_H
#define PERILAT_GENERATOR_KERNEL_CHECK_H

#include <stdio.h>

#include "generator/interpreter/comparison.h"
#include "generator/plan/plan.h"

typedef struct kernel_check {
  long states,
      bonds;  /* random states (laws of bonds); random bonds, as many through each of the six strip
                functions, or through each pass */
  long points; /* random points of a continuum, or tips */
  int passes; /* of all programs (laws of families) */
  comparison outputs;      /* of all functions of the kernel */
  int guards, guards_both; /* conditions of the law, and those seen both true and false */
} kernel_check;

/* Checks `kernel` with each of `sets` parameter sets. Laws of bonds: with bonds of one class,
   `states` states in all and a quarter as many bonds. Laws of families: with a family of the
   `classes` neighbours that `bonds` describes, opposite to number k that numbered k + classes/2,
   and a quarter as many bonds as `states`. Stretches and rotations are log-uniform in size from
   1e-9 up, rates from 1e-3 to 1e6 1/s, damage is often 0 or 1. The same seed gives the same
   states. */
kernel_check kernel_check_run(const kernel_plan *p, const pl_law *kernel,
                              const double *const *parameters, int sets, const pl_bond_class *bonds,
                              int classes, long states, uint64_t seed);

/* All outputs written, none where it may not, and no difference at all. */
bool kernel_check_agrees(const kernel_check *c);
/* One or two sentences about the law `name`: on the standard output, or an error. */
void kernel_check_report(const kernel_check *c, const char *name);

#endif
