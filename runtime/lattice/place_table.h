/* Places and a value at each, of a table or of a result's last frame; the value of the place
   that is nearest to another. */
#ifndef PERILAT_RUNTIME_PLACE_TABLE_H
#define PERILAT_RUNTIME_PLACE_TABLE_H

#include "runtime/deck/deck.h"
#include "runtime/geometry/bins.h"

typedef struct place_table {
  int dimensions;
  long count;
  double *at[3]; /* [count] m; at[2] is NULL in the plane */
  double *value; /* [count] SI */
  bins near;
} place_table;

/* Of the file that `p` names; of a result with several lattices, the places of the lattice of that
   name. False with diagnostics, at `where` for what concerns the file as a
   whole: it cannot be read, is of the other dimensions, lacks the column or field, or that has
   another unit. To be freed in either case. */
bool place_table_read(place_table *t, const deck_placed *p, int dimensions, double spacing,
                      span where, diagnostics *d);
void place_table_free(place_table *t);
/* Mean of the finite values; NaN where there is none. */
double place_table_mean(const place_table *t);

/* The place nearest to `at` and not further than `within`, which is at most the spacing; -1: there
   is none. */
long place_table_nearest(const place_table *t, const double at[3], double within);

#endif
