/* Where a bar lies among the particles of a body: on sites or off them decides how it holds. */
#ifndef PERILAT_RUNTIME_BAR_PLACING_H
#define PERILAT_RUNTIME_BAR_PLACING_H

#include "runtime/lattice/rows.h"

typedef struct bar_placing {
  long inside;              /* particles of the bar with one of the body within its spacing */
  double least, mean, most; /* m, of these: distance to the nearest */
} bar_placing;

bar_placing bar_placing_in(const rows *bar, const rows *body);

#endif
