/* Closed outlines in the plane, of straight edges and arcs of circles. Lengths in m. */
#ifndef PERILAT_RUNTIME_OUTLINE_H
#define PERILAT_RUNTIME_OUTLINE_H

#include <stdbool.h>

typedef struct outline {
  const double *points; /* [count][2] corners, in order; counter-clockwise where there are arcs */
  /* [count] of the edge that begins at each corner: how far the arc rises above its chord, outward
     positive; NULL: all straight */
  const double *bulge;
  int count;
} outline;

/* Smallest box with sides along x and y that holds it; not a number where its numbers are not. */
void outline_box(const outline *o, double lower[2], double upper[2]);

/* Distance of a point to the outline, negative inside: where a ray crosses the outline an odd
   number of times. */
double outline_distance(const outline *o, const double p[2]);

/* Length of the shorter way along the outline between two of its points. */
double outline_way(const outline *o, const double p[2], const double q[2]);

/* What it encloses is less than `tolerance` wide: a polygon folded flat. */
bool outline_is_flat(const outline *o, double tolerance);

/* The ends of edge k. */
const double *outline_corner(const outline *o, int k);

/* Circle of edge k; false for a straight one. */
bool outline_arc(const outline *o, int k, double centre[2], double *radius);

#endif
