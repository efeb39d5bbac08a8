/* A pass over a strip of bonds as C: one loop, or stages (strip_cut.h), as loop_cutting.h decides.

       N = E*A*stretch             for (long q = 0; q < count; q++) {
       D = max(D_old, ...)           const double N = ...;
                                     const int32_t present = (int32_t)flags[q] & present_bit;
                                     at_force_0[q] = present != 0 ? N*e_x : 0.0;
                                     at_field_0[q] = present != 0 ? D : at_field_0[q];
                                   } */
#ifndef PERILAT_GENERATOR_STRIP_H
#define PERILAT_GENERATOR_STRIP_H

#include "generator/target/expression.h"

void strip_pass(emitter *e, const segment *a, const char *name);
/* How the loop of a pass over strips is cut into stages, and what that is estimated to cost: for
   --dump=passes. */
void strip_describe_loops(const kernel_plan *p, const segment *a, FILE *out);

#endif
