/* What belongs to each of several laws on one lattice.

   Of laws of bonds every bond belongs to one: to that of a region where both of its ends stand in
   it, to that `between` two regions where it joins these, else to the law of the material without
   either. Of laws of families each particle belongs to one, to that of its region; a bond bears the
   mean of what the laws of its two ends say:

      lattice   o---o---o---o   region     laws of bonds      1   0   2     0: without region
                0   0 | 2   2              laws of families   1  1+2  2     (o: of law 1 or 2) */
#ifndef PERILAT_RUNTIME_LAW_PARTS_H
#define PERILAT_RUNTIME_LAW_PARTS_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/lattice/rows.h"

typedef struct law_part {
  rows *bonds;        /* rows_part: the bonds that the law has a part in */
  unsigned char *own; /* [size] 1 where a particle is of this law; none is of one between regions */
  double
      *share; /* [size] of laws of families: 1 where a particle is of this law, else 0; or NULL */
} law_part;

/* [count] of the deck's interactions `first`, ..., all of them of the lattice `w`. NULL with
   diagnostics: a particle or a bond of two materials, a material for nothing. */
law_part *law_parts_new(const deck *k, int first, int count, const rows *w, bool families,
                        diagnostics *d);
/* Those of the particles, once they are known. */
void law_parts_take_masses(law_part *parts, int count, const rows *w);
void law_parts_free(law_part *parts, int count);

#endif
