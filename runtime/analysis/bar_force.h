/* Axial forces of the bonds of a bar: along their present direction, tension positive, with all
   that the laws at work exert, dampers too. */
#ifndef PERILAT_RUNTIME_BAR_FORCE_H
#define PERILAT_RUNTIME_BAR_FORCE_H

#include "runtime/interaction/bond_forces.h"

typedef struct bar_force {
  const body *of;
  uint64_t *bonds; /* [size] that are watched */
  long count;
  double *axial;              /* [directions][size] N */
  double middle[3], distance; /* m: of the first one watched; of it from the place asked for */
} bar_force;

/* Of bonds whose ends are both `inside` ([size]; NULL: all): of these the one whose middle is
   nearest to `at` in the reference place, or all of them (NULL). To be freed by bar_force_free. */
bar_force bar_force_new(const body *of, const double *at, const unsigned char *inside);
void bar_force_free(bar_force *b);
/* N: the largest tension, below 0 where all are pressed. The forces have been found
   (bond_forces.h). */
double bar_force_largest(const bar_force *b, bond_forces *f);

#endif
