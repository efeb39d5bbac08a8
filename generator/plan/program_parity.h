/* What the two ends of a bond compute alike, or with the opposite sign. The other end reads u_i for
   u_j and the chord the other way round, so that of a law's values

       u_j - u_i              -1   the ends exchange its terms
       chord + (u_j - u_i)    -1   each term is the opposite
       length                  1   a root of squares of such
       theta + theta_j         1   its terms are a pair that the ends exchange
       theta                   0   the other end has its own */
#ifndef PERILAT_GENERATOR_PROGRAM_PARITY_H
#define PERILAT_GENERATOR_PROGRAM_PARITY_H

#include "generator/plan/program_builder.h"

/* What the other end of a bond computes for a value: 1: the same; -1: the opposite; 0: something
   else, as far as can be seen. */
int program_parity(builder *b, ir_node n);
/* The same; of 0 *far is what the other end computes, made of values that this one has where that
   can be, or IR_NONE where it would need links that nothing else asks for. */
int program_parity_of_root(builder *b, ir_node n, ir_node *far);
/* The terms of a sum, or the factors of a product. */
enum { MOST_TERMS = 24 };
typedef struct term_list {
  ir_node term[MOST_TERMS];
  int sign[MOST_TERMS]; /* of a term; of a factor: -1 below the line */
  int count;
} term_list;
/* Adds those of n; false where they are too many. */
bool program_terms(builder *b, ir_node n, bool of_sum, int sign, term_list *t);

#endif
