/* Particles that stand anywhere, as rows (rows.h) with explicit neighbours. Sites follow a Hilbert
   curve, so that those of a row are near each other; a row has 512 of them, whatever the threads,
   and some absent ones at its end: the last of these is where neighbours lead that are not there.
   Where most stand on a lattice, rows are its lines instead (list_lines.h). Particles keep the
   numbers that they come with, which are those of results.

   Forces and everything else that depends on the order of sites and bonds does not depend on those
   numbers. */
#ifndef PERILAT_RUNTIME_SCATTERED_H
#define PERILAT_RUNTIME_SCATTERED_H

#include "runtime/geometry/neighbour_search.h"
#include "runtime/lattice/rows.h"

typedef struct scattered {
  point_cloud points;
  const double *measure; /* [points.count] m^2 of the plane, m^3 of space and of bars */
  double spacing;        /* m, nominal: scales tolerances and limits, and is told to laws */
  /* [points.count] spacing of each over `spacing`, the smallest; NULL where all have that */
  const double *own_size;
  /* m: bonds join particles at most this far apart, where sizes are given the mean of both sizes
     times this; 0: `neighbours` decides */
  double horizon;
  int neighbours; /* a bond: either particle is among so many nearest ones of the other */
  /* [bond_count] instead of both: these bonds, each once, between particles at different places; no
     particle has more than ROWS_MAX_NEIGHBOURS */
  const point_pair *bonds;
  long bond_count;
  double stiffness_thickness, mass_thickness; /* m; in the plane */
  double
      area; /* m^2: of bars, whose particles have volumes as `measure` and no thickness; else 0 */
} scattered;

/* With `neighbours` the rows' horizon is the radius of a disc or sphere of one particle more than
   that, all of mean size, or where sizes are given of the size 1. NULL when there is not enough
   memory or are 2^31 bonds or more (*crowded
   < 0), or when particle *crowded has more neighbours than there can be. */
rows *scattered_rows(const scattered *from, long *crowded);

/* The particles of a deck's lattice, whose kind deck_lattice_is_irregular; notches that cut bonds
   have cut them. NULL with diagnostics. */
rows *scattered_build(const deck *k, int lattice, diagnostics *d);
/* Where many families of the lattice do not resolve all strains. */
void scattered_warn_unresolved(const rows *w, const deck_lattice *l, diagnostics *d);

#endif
