/* Cuts the loop over a strip of bonds into stages (stages.h). Why: a processor keeps some hundred
   operations in flight. Where those of one bond wait for each other in a long chain, few bonds are
   in flight at once, and the processor waits with them; of short chains it overlaps many.

       load 7 | sub 4 | sqrt 32 | div 24 | atan2 100 | mul 4 | add 4    one loop: 175 cycles
       load 7 | sub 4 | sqrt 32 | div 24 | -> kept                      stage 0: 67
       kept 7 | atan2 100 | -> kept                                     stage 1: 107
       kept 7 | mul 4 | add 4                                           stage 2: 15

   Many cuts are tried, of chains between 50 and 160 cycles, and the cheapest by stage_cost.h is
   taken. Each line is first placed as early as its chain allows; then, from the last line to the
   first, it moves to the first stage that needs it if that saves a buffer. Buffers are given to
   lines that later stages take, and given again where none needs them any more. */
#ifndef PERILAT_GENERATOR_LOOP_CUTTING_H
#define PERILAT_GENERATOR_LOOP_CUTTING_H

#include "generator/emit/stages.h"

/* For the pass that the emitter has open, by estimated cost; `cutting` may forbid or force cuts. */
stages *loop_cutting_plan(const emitter *e, loop_cutting cutting);

#endif
