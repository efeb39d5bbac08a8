/* The form of bonds that add to both ends (OVER_PAIRS): a loop over the bonds that a chunk's
   particles own.

       force = sum(f)      for each bond k {
                             for (q = 0; q < lanes; q++)  value_0 = present ? f : 0.0
                             for (q = 0; q < lanes; q++)  to_0[q] += value_0, far_0[q] -= value_0
                           }
                           slot_0[q] += got[q], got[q] = 0.0      what came from bonds behind

   A chunk is FAMILY_CHUNK particles of one row, whatever thread has it, so that what a particle
   gets comes in one order. A value for the far end is added to family->sum there, and what the
   chunk's own particles have got from behind is theirs after the loop.

   Values of fields toward neighbours are 0 for nearly all bonds and seldom change, and to read and
   write them would take longer than to compute them: eight at a time bear marks of where one is not
   0 (family->old_filled), elsewhere the loop has 0 as a constant; and new values are stored only
   where they differ from what stands there.

   For each bond of the chunk's particles one loop computes values and another adds them to both
   ends, so that the first can be done once more where not all is as it was expected. Later passes
   read where (family->unusual) and need one loop. */
#ifndef PERILAT_GENERATOR_FAMILY_PAIRS_H
#define PERILAT_GENERATOR_FAMILY_PAIRS_H

#include "generator/target/expression.h"

/* What the passes call. */
void family_pairs_functions(emitter *e);
void family_pairs(emitter *e, const segment *a);

#endif
