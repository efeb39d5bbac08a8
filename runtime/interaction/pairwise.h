/* The sweep for laws of bonds: bonds of a row into a row buffer, its forces at once into velocities
   and displacements, so that bond forces never go to memory. Long rows go part by part, so that what one direction of bonds
   loads is in the first cache for the next.

   A row's forces need the bonds of the row below, so that each block evaluates its last row (its seam) first of all. The
   first row of the next block moves when that is done, by whichever thread: a step is one stage, and threads wait for
   all others but once.

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
