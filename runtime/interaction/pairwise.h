/* The sweep for laws of bonds: bonds of a row into a row buffer, its forces at once into velocities
   and displacements, so that bond forces never go to memory. Long rows go part by part, so that
   what one direction of bonds loads is in the first cache for the next.

   A row owns the bonds along it and those up to the next row; its forces need those of the row
   below, too. So each block evaluates its last row (its seam) first of all. The first row of the
   next block moves when that is done, by whichever thread: a step is one stage, and threads wait
   for all others but once. Two blocks of three rows, each in its thread:

     block 0, rows 0 .. 2                       block 1, rows 3 .. 5
     bonds of row 2 (seam)                      bonds of row 5 (seam)
     bonds of row 0 into buffer 0, move row 0   bonds of row 3 into buffer 0, wait for the seam of
     bonds of row 1 into buffer 1, move row 1     block 0, move row 3
     move row 2: its bonds are in the seam      bonds of row 4 into buffer 1, move row 4
                                                move row 5

   Row 1 moves by what stands in buffers 0 and 1, row 3 by the seam of block 0 and its own buffer 0.
   No bond is evaluated from places of two times: row 0 has moved when the bonds of row 1 are, but
   these reach up to row 2 only.

   A particle's force is summed in one order: its own bonds by direction, then those that others own
   by direction. */
#ifndef PERILAT_RUNTIME_PAIRWISE_H
#define PERILAT_RUNTIME_PAIRWISE_H

#include "runtime/interaction/sweep.h"

/* For a sweep whose state is set up. */
sweep_engine pairwise_engine(sweep *w, const double *parameters);

/* What the law's `prepare` gave for the bonds of a direction: [uniform_count]. */
const double *pairwise_uniforms(const sweep *w, int direction);

/* [count of the row] PL_PRESENT, PL_PROTECTED of the bonds that the sites of a row's span own. */
const int64_t *pairwise_flags(const sweep *w, int row);

#endif
