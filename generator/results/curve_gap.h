/* How far a computed curve y(x) lies from measured points, or outside of a band of them, over the
   values of x that both reach. Both are straight between their points. Where a curve comes back in
   x, the first time counts that it reaches each x:

     y |       2        points 1, 2 and 4 count; at the x of 2 the curve jumps
       |     / :        to where the way from 3 to 4 passes it
       |   / 3-*----4
       | 1
       +-------------- x                                                          */
#ifndef PERILAT_GENERATOR_CURVE_GAP_H
#define PERILAT_GENERATOR_CURVE_GAP_H

#include "generator/results/first_reach.h"

typedef struct curve_gap {
  double from, to;  /* the common range of x, as the computed curve goes through it */
  double largest;   /* distance in y; 0 inside of the band */
  double x, y;      /* where that is, on the computed curve */
  double low, high; /* the points, or the band, there */
  double rms;       /* over the common range */
} curve_gap;

/* False when they have no range of x in common. */
bool curve_gap_find(const double *x, const double *y, long count, const curve_points *points,
                    curve_gap *gap);

#endif
