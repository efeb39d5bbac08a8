/* Values at the nodes of a rectangular grid, from a table of places: between them straight along
   each axis. Along an axis with one coordinate alone they are the same. */
#ifndef PERILAT_RUNTIME_PLACE_GRID_H
#define PERILAT_RUNTIME_PLACE_GRID_H

#include "runtime/lattice/place_table.h"

typedef struct place_grid {
  int dimensions;
  long count[3];   /* coordinates of each axis, ascending */
  double *axis[3]; /* m */
  double *value;   /* [count[2]][count[1]][count[0]] SI */
} place_grid;

/* The places in any order. False with a message at `where` where they are no grid: which node is
   missing, or stands there twice. To be freed in either case. */
bool place_grid_open(place_grid *g, const place_table *t, span where, diagnostics *d);
void place_grid_free(place_grid *g);
/* Whether the grid reaches to the place (m), but for rounding. */
bool place_grid_holds(const place_grid *g, const double at[3]);
double place_grid_at(const place_grid *g, const double at[3]);

#endif
