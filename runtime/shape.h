/* Plane shapes of a deck: which points lie in them, which chords cross them. Lengths in m. */
#ifndef PERILAT_RUNTIME_SHAPE_H
#define PERILAT_RUNTIME_SHAPE_H

#include "runtime/deck.h"

/* Smallest box with sides along x and y that holds the shape; not a number where the shape's numbers are not. */
void shape_box(const deck_shape *shape, double lower[3], double upper[3]);

/* True inside, on the outline, and outside within `tolerance` of the outline. A polygon's inside is where a ray
   crosses its outline an odd number of times; a disc with an inner radius is a ring; a point is its own outline. */
bool shape_contains(const deck_shape *shape, const double *point, double tolerance);

/* True when the open chord a-b has a point deeper than `tolerance` inside the shape: touching a corner or running
   along the outline is no crossing. A shape without area (a rectangle of width 0, a polygon folded flat) is a slit:
   every chord that has its ends on either side and meets it, its tip included, crosses it. A point is never
   crossed. */
bool shape_crossed(const deck_shape *shape, const double *a, const double *b, double tolerance);

#endif
