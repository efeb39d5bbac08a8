/* What a law of a deck answers by itself: one bond drawn apart and pressed, one particle or one
   point strained, on the interpreter. */
#ifndef PERILAT_GENERATOR_PAGE_LAW_CURVE_H
#define PERILAT_GENERATOR_PAGE_LAW_CURVE_H

#include "generator/drive/drive_table.h"
#include "generator/kernel/model.h"

typedef struct law_curve {
  drive_table drawn; /* out by a third of the way, back, and out */
  drive_table pressed;
  bool was_pressed; /* else `pressed` is empty */
  drive_kind of;
  double size; /* m: spacing of the bond or particle, size of the point's cell */
} law_curve;

/* `m` is planned without a lattice, `kernel` its interpreted kernel, `l` the deck's lattice. False
   where there is no such curve. To be freed in either case. */
bool law_curve_read(law_curve *c, const model *m, const pl_law *kernel, const double *parameters,
                    const deck_lattice *l);
void law_curve_free(law_curve *c);

#endif
