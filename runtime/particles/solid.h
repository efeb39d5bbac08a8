/* What a lattice's bodies fill less what its notches take away, as one set of points: what lies in
   it, how large it is, and how much of a convex cell it fills. Slits (notches without area or
   volume) take nothing away. Lengths in m. */
#ifndef PERILAT_RUNTIME_SOLID_H
#define PERILAT_RUNTIME_SOLID_H

#include <stdbool.h>

#include "runtime/deck/deck.h"
#include "runtime/geometry/cell.h"

typedef struct solid {
  int dimensions;
  int body_count, notch_count;
  const deck_shape **bodies, **notches;
  double lower[3], upper[3]; /* box about the bodies; lower > upper without bodies */
} solid;

void solid_begin(solid *s, const deck *k, int lattice);
void solid_end(solid *s);

/* In a body or on its surface, and in no notch nor on its surface. */
bool solid_holds(const solid *s, const double at[3]);

/* Memory that the integration uses again and again; one for each thread. */
typedef struct solid_workspace {
  solid near; /* shapes that the cell may touch */
  double *cuts, *levels;
  int cut_count, cut_room, level_count, level_room;
  bool leaves_once; /* every ray from the point leaves the near shapes once */
} solid_workspace;
void solid_workspace_begin(solid_workspace *w, const solid *s);
void solid_workspace_end(solid_workspace *w);

/* Size and first moment, seen from `at`, of the part of the cell about `at` that lies in the solid.
   Up to rounding where the cell lies in one body and, in the plane, where the surfaces in it are
   straight; else steps are halved until two results differ by less than `tolerance` (of the cell's
   size). */
cell_moments solid_fill(const solid *s, solid_workspace *w, const cell *c, const double at[3],
                        double tolerance);

/* True when some of the straight line a-b lies in the solid; both lie in the cell that was filled
   last. */
bool solid_meets(solid_workspace *w, const double a[3], const double b[3]);

/* m^2 or m^3 of the whole, as solid_fill finds it in the box of the bodies, halved into 512 boxes
   and more where shapes crowd; in space to about a thousandth where surfaces are round. */
double solid_size(const solid *s, double tolerance);

#endif
