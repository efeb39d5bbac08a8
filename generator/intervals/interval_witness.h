/* States that show what interval_check suspects. */
#ifndef PERILAT_GENERATOR_INTERVAL_WITNESS_H
#define PERILAT_GENERATOR_INTERVAL_WITNESS_H

#include "generator/check/physics_bench.h"
#include "generator/ir/interval.h"

typedef enum interval_wish {
  WISH_ZERO,
  WISH_NEGATIVE,
  WISH_NOT_POSITIVE,
  WISH_NEGATIVE_BASE,
  WISH_BEYOND_ONE /* larger than 1 in size */
} interval_wish;

typedef struct interval_condition {
  ir_node guard;
  bool truth;
} interval_condition;

/* Text (malloc'ed) of a state within the declared bounds and the ranges of its fields at which
   the conditions hold and `operand` is as wished; NULL when none is found. */
char *interval_witness(bench *b, const range *fields, ir_node operand, interval_wish wish,
                       const interval_condition *conditions, int count);

#endif
