/* Particles that fill a body evenly but at random: darts of a falling least distance (McCool and
   Fiume 1992), then steps of Lloyd (1982) to the centroids of the Voronoi cells inside the body.
   Lengths in m.

   A line of length 1 and three points (spacing 1/3, least distance at first 0.85/3 = 0.28):

        darts    0.40 stays; 0.55 is 0.15 from it, a miss; 0.05 stays; 0.90 stays. After
                 50 misses in a row the least distance falls by 2 %, so that all find a place.
        cells    0 .. 0.225 | 0.225 .. 0.65 | 0.65 .. 1    end half way between neighbours
        Lloyd    0.1125       0.4375          0.825        each point goes to the middle
        again    0.1375       0.453           0.8156       towards 1/6, 1/2, 5/6

   Ten steps are taken; more would freeze the points into grains of a lattice.

   Where the spacing h is graded, darts fall as densely as the particles are to stand, each with a
   distance of its own, and a cell's centroid is that of a mass of density h^-(2 + dimensions):
   cells of a centroidal tessellation are as large as h then (Gersho 1979). */
#ifndef PERILAT_RUNTIME_BLUE_NOISE_H
#define PERILAT_RUNTIME_BLUE_NOISE_H

#include <stdint.h>

#include "runtime/particles/gradation.h"
#include "runtime/particles/voronoi.h"

/* Places p->count points in the body at p->at[dimensions][count]; p->spacing is that of the
   hexagonal or fcc lattice of as many; p->own becomes what the gradation asks for at each, unless
   it is NULL. All lie in the body. The same bits for the same seed,
   whatever the number of threads. */
void blue_noise_fill(voronoi_points *p, const solid *s, const gradation *g, uint64_t seed);

#endif
