/* The sweep for laws of families: the passes of the law's step over all rows, then the particles
   move. Passes read the fields of the beginning of the step and write new ones, which take their
   place when the step is done; values of particles that later passes read from neighbours stand in
   links.

   A pass on a row needs the pass before on all rows in reach, at most. Inside of a block of rows
   the passes therefore follow each other at that distance, some rows at a time, so that what one
   leaves the next finds in a cache. Where rows reach little far, links stand in a window of rows
   (family_window.c): a block does what it needs of its neighbours' rows itself, and its rows move
   as soon as nothing needs where they are. Otherwise (family_stages.c) links of the whole body are
   kept, and what is left of a block at its ends is done pass by pass when all blocks have come so
   far. Bonds may add to both of their ends (family_pairs.c). Results do not depend on the blocks.

   Fields on particles have one plane of [size], all others one for each neighbour, neighbour k +
   directions opposite to k. */
#ifndef PERILAT_RUNTIME_FAMILY_H
#define PERILAT_RUNTIME_FAMILY_H

#include "runtime/interaction/sweep.h"

/* For a sweep whose state is set up. */
sweep_engine family_engine(sweep *w, const double *parameters);

/* J that the particles of a row store, once it was observed. */
double family_stored_in_row(const sweep *w, int row);
/* Adds what a row's particles have lost (sweep_add_losses), where that is kept. */
void family_add_losses(sweep *w, int row);

/* What the law's `prepare` gives for the neighbours of a lattice: [neighbours][uniform_count], on
   lists [uniform_count]; to be freed. */
double *family_uniforms(const pl_law *law, const rows *w, const double *parameters);

#endif
