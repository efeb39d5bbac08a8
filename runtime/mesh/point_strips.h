/* Which groups of cells (cell_strips.h) are taken together: neighbours in a row, so that a law is
   asked for all their points at once. Rectangles that are alike stand side by side in a strip of
   their own, and are found by what their edges do (rectangle_cells.h). A strip is the same whoever
   takes it, so that sums over it are. */
#ifndef PERILAT_RUNTIME_POINT_STRIPS_H
#define PERILAT_RUNTIME_POINT_STRIPS_H

#include "runtime/mesh/cell_strips.h"

typedef struct point_strip {
  int row, first, last; /* groups first <= g < last of a row of cells */
  long at, count;       /* its points */
  bool rectangles;      /* alike, with even volumes; groups are full but for the last */
  pl_rectangle push;    /* of these: slopes times the volume of a point, m^2 */
} point_strip;

typedef struct point_strips {
  point_strip *items; /* row by row */
  int *first_of_row;  /* [rows + 1] */
  long most;          /* points of the largest */
  long bytes;
} point_strips;

/* Of at most `points` points, or of one group; of rectangles at most `of_rectangles`. Without
   `apart` these are like any other cells. The groups must stay. */
point_strips *point_strips_new(const cell_strips *s, bool apart, long points, long of_rectangles);
void point_strips_free(point_strips *p);

#endif
