/* The particles of a link: copies of those of a bar and of the body around it that it joins, and
   the bonds between them, but those that would cross a notch. They stand where theirs do, are as
   heavy, and move with them; a link's law is at work on the bonds.

       bar     o     o     o     o     o          every = 2, first = 0
               |\   /      |\   /      |\
               | \         | \         |          each chosen particle to all
       body    .   .   .   .   .   .   .          within reach
                                                                                     */
#ifndef PERILAT_RUNTIME_LINKED_H
#define PERILAT_RUNTIME_LINKED_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/lattice/rows.h"

/* Of a deck's lattice that is a link; `built` [lattice_count] has those of the lattices before it,
   as they are built. NULL after messages at the deck's line. */
rows *linked_build(const deck *k, int lattice, rows *const *built, diagnostics *d);

/* Masses and moments of inertia of the copies become those of their particles; false where these
   are not known. */
bool linked_take_masses(rows *link, rows *const *built);

#endif
