/* Particles that fill a body evenly but at random: darts of a falling least distance (McCool and Fiume 1992), then steps of
   Lloyd (1982) to the centroids of the Voronoi cells inside the body. Lengths in m. */
#ifndef PERILAT_RUNTIME_BLUE_NOISE_H
#define PERILAT_RUNTIME_BLUE_NOISE_H

#include <stdint.h>

#include "runtime/particles/solid.h"
#include "runtime/particles/voronoi.h"

/* Places p->count points in the body at p->at[dimensions][count]; p->spacing is that of the hexagonal
   or fcc lattice of as many. All lie in the body. The same bits for the same seed, whatever the number of threads. */
void blue_noise_fill(voronoi_points *p, const solid *s, uint64_t seed);

#endif
