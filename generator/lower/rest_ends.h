/* The rest stretch of a bond as each of its two ends finds it. */
#ifndef PERILAT_GENERATOR_REST_ENDS_H
#define PERILAT_GENERATOR_REST_ENDS_H

#include "dsl/base/diagnostics.h"
#include "dsl/semantics/law.h"
#include "runtime/kernel.h"

typedef struct rest_ends {
  bool finite;    /* at rest: both ends alike, states as they begin */
  double both[2]; /* with what is the particles' own drawn around that; the two farthest apart */
} rest_ends;

/* Of a law of lattices with a rest stretch: fields, states, volumes and sums over families are the
   particle's own, states of bonds and toward neighbours the same for both; the chord has another
   sign at the other end. False where the law has none, or cannot be lowered (said in `d`). */
bool rest_ends_find(const law *l, const double *parameters, const pl_bond_class *bonds,
                    rest_ends *out, diagnostics *d);
/* Whether they differ by more than rounding. */
bool rest_ends_differ(const rest_ends *r);

#endif
