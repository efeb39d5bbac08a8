/* The particles of a deck's regions; what is wrong with a region that holds none. */
#ifndef PERILAT_RUNTIME_REGIONS_H
#define PERILAT_RUNTIME_REGIONS_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/lattice/rows.h"

typedef struct region_sites { /* of a region of the deck */
  bool here;                  /* it is of this lattice; else there are no particles */
  int32_t *particles;
  long count;
} region_sites;

/* [deck->region_count] whether anything names the region; to be freed. */
bool *regions_used(const deck *k);
/* [deck->region_count], to be freed by regions_free. Diagnostics of those that are empty, warnings
   of those that nothing names, without the groups of a file; regions of other lattices than the one
   of that name are left out. */
region_sites *regions_select(const deck *k, const char *lattice, const rows *w, diagnostics *d);
void regions_free(const deck *k, region_sites *regions);

#endif
