/* Values that a deck gives by place, at the places of particles. */
#ifndef PERILAT_RUNTIME_PLACED_VALUES_H
#define PERILAT_RUNTIME_PLACED_VALUES_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/kernel.h"
#include "runtime/lattice/rows.h"

/* What an assignment says by place of a parameter, in its unit. */
deck_placed placed_of_parameter(const deck_assignment *a, const pl_parameter *p);

/* [count] of the particles named, where they stand without displacement; SI, finite, to be freed.
   NULL after a message at `where`. */
double *placed_values(const deck_placed *p, const rows *w, const int32_t *particles, long count,
                      span where, diagnostics *d);

#endif
