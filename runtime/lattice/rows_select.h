/* Which particles a shape means: regions, bodies, and what stands near protected ones. */
#ifndef PERILAT_RUNTIME_ROWS_SELECT_H
#define PERILAT_RUNTIME_ROWS_SELECT_H

#include "runtime/deck/deck.h"
#include "runtime/lattice/rows.h"

/* Particles inside or on the shape, ascending; a point gives the nearest within its tolerance.
   `list` is malloc'ed. Returns the count. */
long rows_select(const rows *w, const deck_shape *shape, int32_t **list);

/* body[particle_count]: number, from 0 in the order of the deck, of the first body that each
   particle belongs to. */
void rows_bodies(const rows *w, const deck *k, int lattice, int32_t *body);

/* Holds the damage of every particle within `radius` (m) of one of the `particles`, and of the
   bonds of these. */
void rows_protect(rows *w, const int32_t *particles, long count, double radius);

#endif
