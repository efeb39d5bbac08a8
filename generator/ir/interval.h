/* Sets of numbers from one end to the other, with open and closed ends, and what operations make of them: what values can be
   within the declared bounds of a law. */
#ifndef PERILAT_GENERATOR_INTERVAL_H
#define PERILAT_GENERATOR_INTERVAL_H

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

#endif
