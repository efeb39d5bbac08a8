/* Where the neighbours of particles of a list stand alike (pl_family.alike): PL_LANES particles
   after the other have neighbour k, those that have one, so many sites further and at one chord. */
#ifndef PERILAT_RUNTIME_LIST_WAYS_H
#define PERILAT_RUNTIME_LIST_WAYS_H

#include "runtime/lattice/rows.h"

/* list->alike and list->way, of a list without these; none where there is no memory. In rows that
   are no lines, is_line[row_count], each particle has its own ways. */
void list_ways_find(rows *w, const unsigned char *is_line);
/* The part of all neighbours of particles that stand alike; 0 without ways. */
double list_ways_share(const rows *w);

#endif
