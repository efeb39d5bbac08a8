/* The rows of a deck's Bravais lattice: its family of neighbours, the pitch that gives every
   neighbour a place, the sites of the bodies, the bonds that no notch cuts. */
#ifndef PERILAT_RUNTIME_ROWS_BUILD_H
#define PERILAT_RUNTIME_ROWS_BUILD_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/lattice/rows.h"

/* Sites that are inside or on the outlines of the bodies (tolerance 1e-6 spacing), less the
   notches; bonds between present neighbours whose chord crosses no notch. NULL on errors (a body
   without sites, a point body with no lattice site within its tolerance, too many sites or
   neighbours), reported at the deck's line. */
rows *rows_build(const deck *k, int lattice, diagnostics *d);

#endif
