/* Strains and forces of PL_LANES bilinear rectangles side by side with 2 x 2 points each, by what
   their edges do: differences of displacements along two edges, blended at the points. A third of
   the work that tables of all slopes take (cell_strips.h), to rounding the same. */
#ifndef PERILAT_RUNTIME_RECTANGLE_CELLS_H
#define PERILAT_RUNTIME_RECTANGLE_CELLS_H

#include <stdbool.h>

/* 1/m: x[low or high point][lower or upper edge], y[left or right point][left or right edge].
   Points stand in the order low left, low right, high left, high right; nodes, too. */
typedef struct rectangle_slopes {
  double x[2][2], y[2][2];
} rectangle_slopes;

/* From N_,x and N_,y of the nodes at the points; false where they are none of a rectangle's, or
   differ by more than `least` (1/m). */
bool rectangle_slopes_find(rectangle_slopes *r, const double slope[4][4][2], double least);

/* strain xx, yy, xy [4][PL_LANES]; u at the lower left node of the first cell, rows `stride`
   apart. */
void rectangle_cells_strain(const rectangle_slopes *r, const double *const u[2], long stride,
                            double *const strain[3]);
/* Adds sum B^T stress volume of `cells` of a row to the forces of their nodes. stress xx, yy, xy
   [groups][4][PL_LANES], groups of PL_LANES cells, the last filled up; volume: m^3 of each point;
   force at the lower left node of the first cell; the groups' room and one more is written. */
void rectangle_cells_push(const rectangle_slopes *r, int cells, const double *const stress[3],
                          double volume, double *const force[2], long stride);

#endif
