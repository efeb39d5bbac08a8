/* Sums of products of nodes, so that what is written in several places can cancel: alpha3 -
 * alpha2, 1.001*a*b - a*b. */
#ifndef PERILAT_GENERATOR_INTERVAL_SUMS_H
#define PERILAT_GENERATOR_INTERVAL_SUMS_H

#include "generator/ir/ir.h"

enum { SUM_TERMS = 10, SUM_FACTORS = 6 };

typedef struct sum_term {
  double coefficient;
  int count;
  ir_node factor[SUM_FACTORS]; /* ascending; a square stands twice */
} sum_term;

/* count 0: the number 0. */
typedef struct sum {
  int count;
  sum_term term[SUM_TERMS];
} sum;

/* The node multiplied out as far as it fits; what does not fit stays a factor. */
sum sum_of(const ir *g, ir_node n);
/* a + k b. False when it does not fit. */
bool sum_combine(const sum *a, double k, const sum *b, sum *out);
/* The sum with term `which`, which must be a multiple of one node, replaced by that multiple of b.
 */
bool sum_replace(const sum *a, int which, const sum *b, sum *out);
bool sum_same_factors(const sum_term *a, const sum_term *b);
/* Takes out one factor that all terms share; IR_NONE when there is none. */
ir_node sum_take_factor(sum *a);
/* True when a is a multiple of b. */
bool sum_is_multiple(const sum *a, const sum *b);

#endif
