/* The order of points along a Hilbert curve: points that follow each other there are near each
   other. Neighbours then stand near each other in memory, too. In a square of 4 x 4 cells the curve
   goes

        5  6  9 10      through a quarter before it goes on to the next, and in
        4  7  8 11      each quarter, turned, as through the whole:
        3  2 13 12          the whole  1 2      the quarter at the lower left  3 2
        0  1 14 15                     0 3                                     0 1

   A point's place is found from the bits of its cell, the highest first: they name the quarter, and
   how it is turned. */
#ifndef PERILAT_RUNTIME_HILBERT_H
#define PERILAT_RUNTIME_HILBERT_H

#include <stdint.h>

#include "runtime/geometry/neighbour_search.h"

enum { HILBERT_BITS = 20 }; /* a coordinate */

/* Place along the curve through the grid of 2^HILBERT_BITS cells a side (Skilling 2004, AIP Conf.
   Proc. 707, 381). */
uint64_t hilbert_place(int dimensions, const uint32_t cell[3]);

/* order[count]: the points along a curve through the smallest cube (square) around them; those of
   one cell by x, y, z. It does not depend on how they are numbered. */
void hilbert_order(const point_cloud *c, int32_t *order);

#endif
