/* What values can be within the declared bounds: ranges with open and closed ends, and a check of a
   law that warns of divisions by zero and of roots and logarithms of negative numbers. Inside a
   case line its guard holds, and those above it do not; parameters keep the bounds that relate
   them. */
#ifndef PERILAT_GENERATOR_INTERVAL_H
#define PERILAT_GENERATOR_INTERVAL_H

#include "dsl/semantics/law.h"
#include "generator/ir/ir.h"

/* All numbers from low to high; an open end is not reached, an infinite one never. */
typedef struct range {
  double low, high;
  bool low_open, high_open;
} range;

range range_of(double value);
range range_between(double low, double high, bool low_open, bool high_open);
range range_all(void);
range range_join(range a, range b);
/* What both hold; `a` where they have nothing in common. */
range range_meet(range a, range b);
range range_neg(range a);
range range_add(range a, range b);
range range_mul(range a, range b);
range range_square(range a);
/* All numbers where b holds 0. */
range range_div(range a, range b);
bool range_holds(range a, double value);
bool range_is_positive(range a);    /* all > 0 */
bool range_is_nonnegative(range a); /* all >= 0 */

/* Result of an operation other than those above on the ranges of its operands, as far as it is
 * defined. */
range range_apply(ir_op op, range a, range b);

/* Warns of operations of a pairwise law that the declared bounds do not keep defined
   (division-by-zero, domain) and of damages that they do not keep from 0 to 1 (damage-range). Each
   warning shows a state; what is suspected but not found by drawing states is not said. */
void interval_check(const law *l, diagnostics *d);

#endif
