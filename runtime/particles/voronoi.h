/* Voronoi cells of points in a body: what of the body is nearer to each point than to any other.
   Each cell is cut by itself from a box by the planes half way to the points around, nearest first,
   until none that is left can reach it (Rycroft 2009), and then measured inside the body (solid.h).
   Cost grows as the number of points where these lie evenly; the result has the same bits whatever
   the number of threads. Lengths in m. */
#ifndef PERILAT_RUNTIME_VORONOI_H
#define PERILAT_RUNTIME_VORONOI_H

#include "runtime/particles/solid.h"

typedef struct voronoi_points {
  int dimensions;
  long count;
  double *at[3];  /* [count] m; at[2] is NULL in the plane */
  double spacing; /* m: about the distance of neighbours */
  double *own;    /* [count] m: the same of each point where they differ, none less; or NULL */
} voronoi_points;

/* volume[count] in m^2 or m^3 and, unless that is NULL, centroid[dimensions][count], which may lie
   out of a body that is not convex. Cells are exact up to rounding in a box and wherever they lie
   wholly inside a body; others are so to `tolerance` of a cell. A point outside of the body has
   what of the body is nearest to it. Where points leave gaps, cells are let grow until they end; a
   part of the body without any point of its own, more than two spacings of void away from all, may
   belong to none. No two points coincide. */
void voronoi_measure(const voronoi_points *p, const solid *s, double tolerance, double *volume,
                     double *const centroid[3]);

/* The first pair of points, by the number of the first, that are less than `distance` > 0 apart.
   False when there is none. */
bool voronoi_too_near(const voronoi_points *p, double distance, long pair[2]);

#endif
