/* This room: particles, their bonds, and what differs from bond to bond. Here the particles of a
   deck's lattice and the bonds between them, whether they stand on sites that repeat themselves
   (rows.h), nowhere in particular (scattered.h) or along a bar (bar_rows.h). */
#ifndef PERILAT_RUNTIME_LATTICE_H
#define PERILAT_RUNTIME_LATTICE_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/lattice/rows.h"

/* NULL after messages at the deck's line. To be freed by rows_free. */
rows *lattice_build(const deck *k, int lattice, diagnostics *d);
/* The same of one after the other: `built` [lattice_count] has those that came before it, which a
   link joins. */
rows *lattice_build_next(const deck *k, int lattice, rows *const *built, diagnostics *d);

#endif
