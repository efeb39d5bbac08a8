/* What is known in a branch of a law: relations that its guards give, as sums that are not
   negative, positive or not zero.

     w = | 0          if r <= r_0         in the second line r - r_0 > 0 is known, so that
         | 1 - r_0/r  otherwise           r is not 0 where r_0 >= 0, and r_0/r < 1 */
#ifndef PERILAT_GENERATOR_INTERVAL_CONTEXT_H
#define PERILAT_GENERATOR_INTERVAL_CONTEXT_H

#include "generator/check/physics_bench.h"
#include "generator/intervals/interval_sums.h"
#include "generator/ir/interval.h"

enum { MOST_RELATIONS = 24 };

typedef enum relation_kind { NOT_NEGATIVE, POSITIVE, NOT_ZERO } relation_kind;
typedef struct relation {
  relation_kind kind;
  sum of;
} relation;

/* What is known in a branch: relations, and ranges of nodes that follow from them. */
typedef struct context {
  struct context *outer;
  relation relations[MOST_RELATIONS];
  int relation_count;
  ir_node guard; /* that made it; IR_NONE for the whole law */
  bool truth;
  range *known;         /* [nodes] */
  unsigned char *state; /* [nodes] */
} context;

typedef struct analysis {
  bench *bench;
  ir *graph;
  const law *law;
  diagnostics *said;
  arena *memory;
  int nodes, contexts, most_contexts, searches, depth;
  long combinations;      /* of sums with relations so far */
  ir_node *lower, *upper; /* [parameters] */
  range *fields;          /* [fields] what a bond can reach from the initial values */
  unsigned char *tried;   /* [nodes] searches for a state, in different branches */
  unsigned char *solved;  /* [nodes] what the text does not hold */
  bool quiet;
} analysis;

/* An inner one; `outer` is NULL for that of the whole law, whose guard is IR_NONE. */
context *context_new(analysis *a, context *outer, ir_node guard, bool truth);
/* more - less > 0 and the like. */
void context_relate(analysis *a, context *c, relation_kind kind, ir_node less, ir_node more);
/* The same of a sum. */
void context_add_relation(const ir *g, context *c, relation_kind kind, const sum *of);

/* The sums with either operand in place of max, min or |x| in term k; false where it holds none. */
bool sum_unbend(const ir *g, const sum *s, int k, sum *with_first, sum *with_second);
/* True when the sum is at most both of those that sum_unbend gives: c - |x| is at most c - x and
   c + x. */
bool sum_term_is_least(const ir *g, const sum_term *t);

#endif
