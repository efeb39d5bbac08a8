/* Tributary lengths: how much of a row of particles, or of a bar, belongs to each of its particles.
   A row ends where its body does, which need not be half way to the next site:

       body   |------------------------------|
       row      o     o     o     o     o          the ends have more than half a spacing
              |----|-----|-----|-----|-------|
 */
#ifndef PERILAT_RUNTIME_TRIBUTARY_H
#define PERILAT_RUNTIME_TRIBUTARY_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/lattice/regions.h"
#include "runtime/lattice/rows.h"

/* length[at->count], m, of the particles of a region of the deck's lattice. Of a bar's particle
   half of the parts beside it. Of others what of the straight line through them lies in the bodies,
   in no notch, and nearer to this one than to any other particle of the line, in the region or
   not; at an end at most as far as the next particle is away. Bodies without area or volume bound
   nothing: there an end has half of that. False after a message at `where`: the particles are no
   row. */
bool tributary_lengths(const deck *k, int lattice, const rows *w, const region_sites *at,
                       const char *region, span where, double *length, diagnostics *d);

#endif
