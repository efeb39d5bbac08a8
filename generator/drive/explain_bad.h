/* The line of a law that first stops being finite. */
#ifndef PERILAT_GENERATOR_EXPLAIN_BAD_H
#define PERILAT_GENERATOR_EXPLAIN_BAD_H

#include <stdio.h>

#include "generator/plan/plan.h"
#include "runtime/simulation/simulation.h"

/* Names the first quantity of the law, with its line, that is not finite in the bond state `b`;
   when all are finite the last one with its value. */
void explain_bad(const kernel_plan *p, const double *parameters, const pl_bond_class *bonds,
                 const bad_state *b, FILE *out);

#endif
