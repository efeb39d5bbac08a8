/* Dataflow graph of scalar operations. Nodes are hash-consed and simplified as they are made, so
   equal subexpressions are one node and a graph built twice is the same graph. Nodes only refer to
   earlier nodes: the node numbers are an evaluation order. Logical nodes hold 0 or 1. Rewrites
   never change a value: x*1, x+0, signs moved outward, constants folded with the very functions of
   elementary.h, division by a power of two as multiplication; not x-x, 0*x or reassociation, so
   that NaN and rounding stay as written. The one thing they do not keep is the sign of a zero. */
#ifndef PERILAT_GENERATOR_IR_H
#define PERILAT_GENERATOR_IR_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "dsl/base/source.h"
#include "dsl/syntax/tree.h"
#include "generator/ir/operation.h"

typedef int32_t ir_node;
#define IR_NONE (-1)

/* Where an input's value comes from; with `index` it identifies the input. */
typedef enum ir_source {
  IR_FROM_PARAMETER,      /* index: law->parameters */
  IR_FROM_QUANTITY,       /* index: builtin_quantity */
  IR_FROM_FIELD,          /* index: law->fields; the value at hand: old one when a step begins */
  IR_FROM_BOND_PARAMETER, /* index: of the parameters that differ from bond to bond (kernel_plan) */
  IR_FROM_PARTICLE_PARAMETER,  /* index: of those that differ from particle to particle */
  IR_FROM_NEIGHBOUR_PARAMETER, /* the same of the neighbour */
  IR_FROM_ENDS, /* index: enum ends_input of kinematics.h: particle arrays at the bond's ends */
  /* in programs of families (program.h) */
  IR_FROM_SHAPE, /* index: entry of the particle's inverse shape matrix */
  /* Index: law->fields; of the neighbour, toward me where it is directed */
  IR_FROM_NEIGHBOUR_FIELD,
  IR_FROM_LINK,                /* index: value of the particle that an earlier pass left */
  IR_FROM_NEIGHBOUR_LINK,      /* the same of the neighbour */
  IR_FROM_BOND_LINK,           /* index: value toward each neighbour that an earlier pass left */
  IR_FROM_NEIGHBOUR_BOND_LINK, /* the same of the neighbour toward me */
  IR_FROM_SHARED,              /* index: value that the owner of the bond has left for both ends */
  IR_FROM_SHARED_ODD,          /* the same of a value that has the opposite sign at the other end */
  IR_FROM_NEW_FIELD, /* toward the neighbour, from an earlier pass of the step; index: field */
  IR_FROM_SLOT,      /* index: value of the particle within a pass */
  IR_FROM_PLANE,     /* index: value toward each neighbour within a pass */
  IR_FROM_TIP,       /* index: tip_input of point_inputs.h: what the tip of a crack has */
  IR_FROM_POINT,     /* index: point_input of point_inputs.h: what a point of a continuum has */
  IR_FROM_SEARCH,    /* where the search is: bound in IR_SEARCH, unknown outside */
  IR_SOURCE_COUNT
} ir_source;

/* Of a parameter that is not the same everywhere. */
static inline bool ir_is_parameter(ir_source from) {
  return from >= IR_FROM_BOND_PARAMETER && from <= IR_FROM_NEIGHBOUR_PARAMETER;
}

typedef struct ir ir;

ir *ir_new(void);
void ir_free(ir *g);
/* The texts that spans refer to (not owned): with them ir_dump prints line numbers. */
void ir_set_sources(ir *g, const source_set *sources);

ir_node ir_constant(ir *g, double value);
/* `name` is kept for printing; place says how often it varies (ON_BODY: uniform over the
   lattice). */
ir_node ir_input(ir *g, ir_source source, int index, const char *name, placement place);
/* Unused operands: IR_NONE. A number where a truth value is wanted means "other than 0". */
ir_node ir_make(ir *g, ir_op op, ir_node a, ir_node b, ir_node c);
static inline ir_node ir_unary(ir *g, ir_op op, ir_node a) {
  return ir_make(g, op, a, IR_NONE, IR_NONE);
}
static inline ir_node ir_binary(ir *g, ir_op op, ir_node a, ir_node b) {
  return ir_make(g, op, a, b, IR_NONE);
}

/* Shorthands. */
ir_node ir_add(ir *g, ir_node a, ir_node b);
ir_node ir_sub(ir *g, ir_node a, ir_node b);
ir_node ir_mul(ir *g, ir_node a, ir_node b);
ir_node ir_div(ir *g, ir_node a, ir_node b);
ir_node ir_neg(ir *g, ir_node a);
ir_node ir_scaled(ir *g, double factor, ir_node a);
/* What ir_search looks for, in `step` and `open`. */
ir_node ir_sought(ir *g);
/* From `start` on, where a search by `step` ends that goes on where `open` is not 0 (pl_search). */
ir_node ir_search(ir *g, ir_node start, ir_node step, ir_node open);
/* Changes while a search goes on. */
bool ir_is_sought(const ir *g, ir_node n);
ir_node ir_select(ir *g, ir_node condition, ir_node yes, ir_node no);
/* a ** n by repeated squaring for whole |n| <= 16, with a square root for halves, cbrt for 1/3, one
   division where n is negative; pow otherwise. */
ir_node ir_power(ir *g, ir_node base, ir_node exponent);

/* Gives a node the model's name and place in the source, unless it has one already. Constants stay
   nameless: one number may stand for many things. Names are copied. */
void ir_set_name(ir *g, ir_node n, const char *name, span where);

int ir_count(const ir *g);
ir_op ir_operation(const ir *g, ir_node n);
int ir_arity(ir_op op);
const char *ir_op_name(ir_op op);
ir_node ir_operand(const ir *g, ir_node n, int k);
double ir_value(const ir *g, ir_node n); /* CONSTANT */
/* A constant of this value; of zero either sign. */
bool ir_is_number(const ir *g, ir_node n, double value);
ir_source ir_input_source(const ir *g, ir_node n); /* INPUT */
int ir_input_index(const ir *g, ir_node n);        /* INPUT */
placement ir_place(const ir *g, ir_node n);        /* the most local of its operands */
/* Says that an input, placed ON_BODY, differs from neighbour to neighbour but not along a row of a
   lattice (its bond's length, say); so does what is made of it, except sums over the family.
   Returns the input. */
ir_node ir_mark_class(ir *g, ir_node input);
bool ir_is_of_class(const ir *g, ir_node n);
/* The same everywhere in the body, unless it is of a class. */
static inline bool ir_is_uniform(const ir *g, ir_node n) {
  return ir_place(g, n) <= ON_BODY;
}
/* One value for all bonds of a particle. */
static inline bool ir_is_of_particle(const ir *g, ir_node n) {
  return ir_place(g, n) <= ON_PARTICLE && !ir_is_of_class(g, n);
}
/* Says that a condition holds nearly always, so that what is chosen where it does not need not be
   fast. Returns it. That a size, at least 0, is below a positive limit (choice_expectation); or any
   condition, once the graph is rewritten no more. */
ir_node ir_expect(ir *g, ir_node size_is_small);
ir_node ir_expect_any(ir *g, ir_node condition);
bool ir_is_expected(const ir *g, ir_node n);
bool ir_is_expected_of_size(const ir *g, ir_node n);
/* Chooses by such a condition. */
bool ir_is_expected_choice(const ir *g, ir_node n);
bool ir_is_logical(const ir *g, ir_node n);
/* Whether finite inputs could make a node NaN: what MAKES_NAN, of something that varies over the
   lattice, stands at or below it. Overflow is left aside. */
bool ir_may_be_nan(const ir *g, ir_node n);
bool ir_is_reduction(ir_op op); /* over the family: its operand has a value for each neighbour */
const char *ir_name(const ir *g, ir_node n); /* NULL without a name */
span ir_where(const ir *g, ir_node n);       /* of the named source line; end == 0 without */

/* Rebuilds `roots` with each node from[k] replaced by to[k], all at once: what stands in to[k] is
   left alone. Results in out[root_count]. A root may be IR_NONE here and in the walks below: it
   needs nothing. */
void ir_substitute(ir *g, const ir_node *roots, int root_count, const ir_node *from,
                   const ir_node *to, int pair_count, ir_node *out);
/* The same root by root: what one root has rebuilt stands for the next ones. Pairs may be added
   whose `from` no root so far needs. */
typedef struct ir_substitution ir_substitution;
ir_substitution *ir_substitution_new(ir *g);
void ir_substitution_add(ir_substitution *s, ir_node from, ir_node to);
ir_node ir_substitution_apply(ir_substitution *s, ir_node root);
void ir_substitution_free(ir_substitution *s);
/* Marks (1 byte a node, ir_count long, zeroed by the caller) all nodes that the roots need. */
void ir_mark(const ir *g, const ir_node *roots, int root_count, unsigned char *marks);

/* Counts of operations that the roots cost: additions, multiplications, divisions and square roots,
   other functions, selects (with min, max, sign); those of nodes placed `at_least` so locally, but
   for the marked ones (NULL: none). */
typedef struct ir_cost {
  int additions, multiplications, divisions, functions, selects;
} ir_cost;
ir_cost ir_count_cost(const ir *g, const ir_node *roots, int root_count, placement at_least,
                      const unsigned char *but);

/* One line a node that the roots need: "%7 = mul %3 %5 : bond  ; omega (line 12)". */
void ir_dump(const ir *g, const ir_node *roots, const char *const *root_names, int root_count,
             FILE *out);

#endif
