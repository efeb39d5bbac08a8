/* The particles of a bar along its polyline, each joined to the next, as rows with a list
   (scattered.h). A leg is divided into equal parts as near to the spacing as can be. A particle
   stands for half of the parts beside it, at a free end for a whole part. */
#ifndef PERILAT_RUNTIME_BAR_ROWS_H
#define PERILAT_RUNTIME_BAR_ROWS_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/lattice/rows.h"

/* Of a deck's lattice that deck_lattice_is_bar. The rows' spacing is the mean length that a
   particle stands for. Notches leave it whole, with a warning where it crosses one. NULL after a
   message. */
rows *bar_rows(const deck *k, int lattice, diagnostics *d);

/* A straight bar along x of so many particles, else as `like`; NULL without memory. */
rows *bar_rows_straight(const rows *like, int particles);

#endif
