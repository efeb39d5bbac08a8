/* The form of passes with unrolled neighbours (FORM_UNROLLED): one loop over the particles of
   a run, in which neighbour stands after neighbour; what segments leave for each other stays in
   registers.

       d = sum(V_j*stretch)    at_slot_0 = 0.0;
                               { const double stretch = ...;
                                 present = (at_bits_0[q] & UINT64_C(1) << 0) != 0;
                                 at_slot_0 = present ? pl_fma(V_j, ..., at_slot_0) : at_slot_0; }
                               { ... the same of the next neighbour ... }
                               at_result_0[q] = d/m;

   Arrays and the values of bond classes are named before the loop, each once, by a number; slots
   and planes are variables, and so is what an array holds, read once: compilers do not see that it
   is still the same behind what was written in between. */
#ifndef PERILAT_GENERATOR_FAMILY_UNROLLED_H
#define PERILAT_GENERATOR_FAMILY_UNROLLED_H

#include "generator/target/expression.h"

void family_unrolled_pass(emitter *e, const program_pass *p);

#endif
