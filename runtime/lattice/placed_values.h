/* Values that a deck gives by place, at the places of particles. */
#ifndef PERILAT_RUNTIME_PLACED_VALUES_H
#define PERILAT_RUNTIME_PLACED_VALUES_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/lattice/rows.h"

/* [count] of the particles named, where they stand without displacement; SI, finite, to be freed.
   NULL after a message at `where`. */
double *placed_values(const deck_placed *p, const rows *w, const int32_t *particles, long count,
                      span where, diagnostics *d);

#endif
