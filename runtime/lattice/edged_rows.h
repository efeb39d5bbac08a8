/* Particles on the sites of a lattice whose families and volumes are each of their own, so that
   those at edges and notches, which lack neighbours, can have exact operators (edges = 'exact'). */
#ifndef PERILAT_RUNTIME_EDGED_ROWS_H
#define PERILAT_RUNTIME_EDGED_ROWS_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/lattice/rows.h"

/* The particles of rows_build in their order, and its bonds, as rows with a list (scattered.h). A
   particle that lacks neighbours of its family is joined to neighbours of its neighbours, too:
   whole shells, nearest first, none across a notch, until it has lattice_usual_neighbours, or as
   many as a whole family where that is more. Where they are fewer than those of a whole family,
   their neighbours come in, too. Volumes are those of the Voronoi cells, cut by the bodies and by
   notches with an area or a volume. NULL with diagnostics. */
rows *edged_rows(const deck *k, int lattice, diagnostics *d);

/* What such rows are beside the lattice's. */
typedef struct edged_rows_facts {
  int whole;          /* neighbours of a whole family of the lattice */
  long short_of;      /* particles that lack some of these */
  long further;       /* bonds that they have besides */
  double least, most; /* volumes of particles, over that of a site */
} edged_rows_facts;
edged_rows_facts edged_rows_look(const rows *w, const deck_lattice *l);

#endif
