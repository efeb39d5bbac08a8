/* Of a page's frames the cells of meshes: which are there, and those that a crack cuts, in parts
   that come apart; the faces of cracks. */
#ifndef PERILAT_GENERATOR_PAGE_MOVIE_CELLS_H
#define PERILAT_GENERATOR_PAGE_MOVIE_CELLS_H

#include "generator/page/packing.h"
#include "runtime/plot/plot_frame.h"

typedef struct movie_cells {
  int32_t *corners; /* [count][4] of all meshes, at the beginning */
  long count, frames;
  packing listed; /* the corners, each counted from the one before */
  /* [frames] */
  packing *alive; /* runs: 0 a cell that has died, 1 whole, 2 cut by a crack */
  packing *parts; /* of cells that are cut: a node whose values they have, four places and four
                     displacements */
  packing *faces; /* of cracks: how many points, and these: places and displacements, floats */
} movie_cells;

/* What the first frame has. */
void movie_cells_begin(movie_cells *m, const plot_meshes *meshes, long frames);
/* Frame k: places at the beginning between low and high, displacements [particles][2] between
   range[0] and range[1], m. */
void movie_cells_take(movie_cells *m, long k, const plot_frame *f, const double *u,
                      const double low[2], const double high[2], const double range[2]);
void movie_cells_free(movie_cells *m);

#endif
