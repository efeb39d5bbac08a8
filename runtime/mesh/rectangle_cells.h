/* Strains and forces of bilinear rectangles side by side with 2 x 2 points each (rectangle.h):
   PL_LANES of them at a time. A third of the work that tables of all slopes take (cell_strips.h),
   to rounding the same. */
#ifndef PERILAT_RUNTIME_RECTANGLE_CELLS_H
#define PERILAT_RUNTIME_RECTANGLE_CELLS_H

#include <stdbool.h>

#include "runtime/rectangle.h"

enum { RECTANGLE_PUSHES = 8 }; /* planes: along x at each of the four nodes, along y */

/* From N_,x and N_,y of the nodes at the points; false where they are none of a rectangle's, or
   differ by more than `least` (1/m). */
bool rectangle_slopes_find(pl_rectangle *r, const double slope[4][4][2], double least);
/* Times the volume of a point, m^3: slopes of forces. */
pl_rectangle rectangle_slopes_times(const pl_rectangle *r, double volume);

/* strain xx, yy, xy [4][PL_LANES]; u at the lower left node of the first cell, rows `stride`
   apart. */
void rectangle_cells_strain(const pl_rectangle *r, const double *const u[2], long stride,
                            double *const strain[3]);
/* What each of groups of PL_LANES cells does to its nodes: pushed[RECTANGLE_PUSHES][cells], N,
   written. stress xx, yy, xy [groups][4][PL_LANES]; r: slopes times the volume. */
void rectangle_cells_push(const pl_rectangle *r, int groups, const double *const stress[3],
                          double *const pushed[RECTANGLE_PUSHES]);
/* Adds that of `cells` of a row to the forces of their nodes; force at the lower left node of the
   first cell. */
void rectangle_cells_gather(int cells, double *const pushed[RECTANGLE_PUSHES],
                            double *const force[2], long stride);

/* Sums over rows that are nothing but such cells, from the left and from below, which kernels go on
   with (pl_rectangles): what a row does to its upper nodes waits for the next one. The sum at a
   node is the same to the bit where it does not wait but is added later. */
typedef struct rectangle_rows {
  double *above[2];   /* [nodes of a row] N */
  double right[2][2]; /* [axis][low and high] N: what the last cell does to its right nodes */
} rectangle_rows;

/* Before a row below which there is none: its nodes first <= n < end. */
void rectangle_rows_begin(rectangle_rows *r, int first, int end);
/* The last node of a row; force: of it. */
void rectangle_rows_end(rectangle_rows *r, int node, double *const force[2]);

#endif
