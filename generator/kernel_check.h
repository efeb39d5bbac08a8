/* A compiled kernel against the interpreter, on random states that reach every case of the law; and the line of a law
   that first stops being finite. */
#ifndef PERILAT_GENERATOR_KERNEL_CHECK_H
#define PERILAT_GENERATOR_KERNEL_CHECK_H

#include <stdio.h>

#include "generator/passes.h"
#include "runtime/deck.h"
#include "runtime/rows.h"
#include "runtime/simulation.h"

typedef struct kernel_check {
  long states;
  double largest_ulps;     /* over results, new fields and tangents; infinite where one is NaN and the other not */
  const char *worst;       /* what it was, e.g. "N" */
  long unwritten;          /* outputs that the kernel left as they were */
  int guards, guards_both; /* conditions of the law, and those seen both true and false */
} kernel_check;

/* Compares `states` and `tangent` of the kernel with the plan's interpreter for `count` random states. Stretches and
   rotations are log-uniform in size (1e-9 to 1) with either sign, rates in 1e-3 to 1e6 1/s, damage uniform in [0, 1] and
   often exactly 0 or 1. The same seed gives the same states. */
kernel_check kernel_check_run(const kernel_plan *p, const pl_law *kernel, const double *parameters,
                              long count, uint64_t seed);

/* The same as a sentence to `out`; false when they differ by more than 1 ulp or an output was not written. */
bool kernel_check_report(const kernel_plan *p, const pl_law *kernel, const double *parameters, long count, FILE *out);

/* Distance in units in the last place of the larger; 0 for equal (also NaN and NaN), infinite when only one is NaN. */
double ulps_between(double a, double b);

/* Names the first quantity of the law, with its line, that is not finite in the bond state `b`. */
void kernel_check_explain_bad(const kernel_plan *p, const double *parameters,
                              const rows *w, const bad_state *b, FILE *out);

#endif
