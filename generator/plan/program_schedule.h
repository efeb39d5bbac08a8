/* The segments of a pass: in which loop each value is computed, and what is kept between loops.
   Loops stand in turn, particles 0, neighbours 0, particles 1, neighbours 1, ...; a value has the
   phase of the first in which it can be had: a sum over the family one more than what it adds up.
   Segments are looked at from the last one back, since what one needs of earlier loops is asked of
   those: of a particle as a slot, toward each neighbour as a plane where it is dear.

   The energy of the example in program.h, sum(s F[j] stretch[j])/4, of one pass:

       neighbours 0   plane 0 = stretch      wanted again below: a root is not computed twice
                      slot 2 += 1, slot 3 += stretch
       particles 1    slot 1 = theta         slot 3/slot 2
       neighbours 1   slot 0 += s F stretch  of slot 1 and plane 0
       particles 2    observed 0 = slot 0/4

   Nothing is left for particles 0: empty segments are dropped. */
#ifndef PERILAT_GENERATOR_PROGRAM_SCHEDULE_H
#define PERILAT_GENERATOR_PROGRAM_SCHEDULE_H

#include "generator/plan/program_builder.h"

/* What the other end of a bond adds up, of sums over the family as a pass sees them
   (program_parity_of_root). */
typedef struct pass_ends {
  node_map parity; /* + 1 */
  node_map far;    /* where parity is 0 and it is known */
} pass_ends;

/* Makes the segments of a pass that computes the roots of `wanted`. With `pairs` a loop that
   both ends of a bond would do alike is done bond by bond. */
void program_schedule(ir *g, arena *memory, program_pass *pass, const segment *wanted,
                      const pass_ends *ends, bool pairs);

#endif
