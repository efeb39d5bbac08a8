/* Ways that many bonds have in common: particles of a list may stand on a lattice, all or nearly
   all. Bonds that differ by no more than the rounding of places are taken to be alike, and get one
   chord. In lines of particles along a common way the neighbours of a number stand side by side. */
#ifndef PERILAT_RUNTIME_BOND_WAYS_H
#define PERILAT_RUNTIME_BOND_WAYS_H

#include <stdbool.h>

#include "runtime/geometry/neighbour_search.h"

enum { BOND_WAYS_MOST = 256, BOND_WAYS_MOST_COMMON = 64 };

typedef struct bond_ways {
  int count, common;               /* the common ones come first, the most common before all */
  double chord[BOND_WAYS_MOST][3]; /* [count] m; to higher z, else y, else x */
  long bonds[BOND_WAYS_MOST];      /* [count] that go this way */
  /* [pairs] 1 + which way leads from i to j; less than 0: from j to i; 0: the bond has its own */
  int16_t *of;
} bond_ways;

/* Whether most bonds go common ways. What is found does not depend on numbers. */
bool bond_ways_find(const point_cloud *points, const point_pairs *pairs, double spacing,
                    bond_ways *w);
void bond_ways_free(bond_ways *w);

/* The points in lines along a common way: order[count] line after line, length[lines] of each, to
   be freed. Returns how many lines there are. */
long bond_ways_lines(const bond_ways *w, int way, const point_cloud *points, double spacing,
                     int32_t *order, int32_t **length);

#endif
