/* Owners and numbers for the bonds of particles that stand anywhere. Every bond gets an owner, so
   that each particle owns half of its bonds (to one); and a number, so that the bonds a particle
   owns have different numbers, and so have those that others own. There are as many numbers as the
   particle with most bonds on one of these sides has, no more (Konig 1916): a bipartite graph,
   owners against others, whose edges are coloured. */
#ifndef PERILAT_RUNTIME_BOND_NUMBERS_H
#define PERILAT_RUNTIME_BOND_NUMBERS_H

#include "runtime/geometry/neighbour_search.h"
#include "runtime/lattice/bond_ways.h"

typedef struct numbered_bond {
  int32_t owner, other;
  int32_t number; /* from 0 */
} numbered_bond;

/* bonds[pairs->count], in the order of the pairs. There are fewer than 2^31, and no particle has
   more than 128. Returns how many numbers there are: at most half of the bonds of the particle that
   has most, rounded up. */
int bond_numbers(const point_pairs *pairs, long particles, numbered_bond *bonds);

/* The same for particles most of whose bonds go common ways (bond_ways.h): of these the number is
   that of the way, and its beginning the owner; those of all others are higher. 0 where there
   would be more than 64. */
int bond_numbers_by_ways(const point_pairs *pairs, long particles, const bond_ways *ways,
                         numbered_bond *bonds);

#endif
