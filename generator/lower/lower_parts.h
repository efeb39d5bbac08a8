/* Inside of the lowering, shared by its parts: lower.c does rules and results, lower_value.c
   expressions, lower_family.c what goes over a family and what is a tensor. */
#ifndef PERILAT_GENERATOR_LOWER_PARTS_H
#define PERILAT_GENERATOR_LOWER_PARTS_H

#include "generator/lower/lower.h"

/* Expanding functions can grow a law without bound; these limits are far beyond any real one. */
enum { MOST_NODES = 50000, MOST_VISITS = 2000000, MOST_CALLS_DEEP = 64, CALL_BUCKETS = 256 };

enum { TENSOR_XX, TENSOR_YY, TENSOR_ZZ, TENSOR_XY, TENSOR_YZ, TENSOR_XZ, TENSOR_COUNT };

/* A value: one node for a number, a truth value or a bending quantity (which has one component in a
   plane), three for a vector, six for a symmetric tensor (not engineering shear). */
typedef struct components {
  int count;
  ir_node of[TENSOR_COUNT];
} components;

typedef struct binding {
  const symbol *symbol; /* NULL: a free place */
  components value;     /* count 0 while its rule is being lowered */
} binding;

/* A call that has been expanded: the same function of the same arguments is the same value. */
typedef struct known_call {
  const stmt *function;
  const components *arguments;
  components result;
  struct known_call *next;
} known_call;

typedef struct frame { /* of the function being expanded */
  const stmt *function;
  const components *arguments;
  int depth;
} frame;

typedef struct lowering {
  const law *law;
  ir *graph;
  lower_mode mode;
  arena *memory;
  diagnostics *said;
  bool failed;
  long visits;
  const frame *frame;
  binding *bound; /* [bound_room] open addressing by symbol; a power of two and at least twice the
                     bindings */
  size_t bound_count, bound_room;
  known_call *calls[CALL_BUCKETS];
  ir_node *new_value; /* [fields] what names read below the rule: an opaque input until the end */
  ir_node *rule;      /* [fields] value of the rule, or IR_NONE before it */
  int *rule_order;    /* fields in the order of their rules */
  int rule_count;
  lowered_text text; /* LOWER_STEP; grown by malloc, copied to `memory` at the end */
  int group_count;
} lowering;

/* Reports the first reason why the law cannot be compiled; a number to go on with. */
ir_node lower_fail(lowering *c, span where, const char *what);
components lower_failed_value(lowering *c, span where, const char *what);
bool lower_is_state_law(const lowering *c);

static inline ir_node unary(ir *g, ir_op op, ir_node a) {
  return ir_make(g, op, a, IR_NONE, IR_NONE);
}
static inline ir_node binary(ir *g, ir_op op, ir_node a, ir_node b) {
  return ir_make(g, op, a, b, IR_NONE);
}
static inline components scalar(ir_node n) {
  return (components){1, {n}};
}

/* --- lower_value.c --- */

/* Room for one more of `count` items. */
void *lower_one_more(void *items, int count, size_t size);

components lower_value(lowering *c, const expr *e);
/* The same where one number is expected. */
ir_node lower_expr(lowering *c, const expr *e);
components *lower_binding_of(lowering *c, const symbol *s);
void lower_bind(lowering *c, const symbol *s, components value);
/* Constants and inputs keep their own names. */
void lower_name_node(ir *g, ir_node n, const char *name, span where);
void lower_name_value(lowering *c, components value, const char *name, span where);

/* --- lower_family.c --- */

/* The values that the neighbour has, toward me where it has one for each of its own neighbours. */
components lower_neighbour(lowering *c, components value);
/* Number of bonds of the particle. */
ir_node lower_family_size(ir *g);
/* Whether a force state is in N/m^6, and what it is in N: the bond force, the mean of both sides' forces in N, is the sum
   of both sides' densities times both volumes. */
bool lower_is_per_volumes(dimension d);
ir_node lower_force_of_density(lowering *c, ir_node density);
/* Unit vector along the reference bond, from i to j. */
components lower_direction(lowering *c);
/* Of the particle at hand, m^3. */
ir_node lower_volume(lowering *c);
/* 1 where the bonds of the particle resolve all strains, else 0. */
ir_node lower_resolved(lowering *c);
/* Functions of families and tensors. False: it is neither. */
bool lower_family_call(lowering *c, const expr *e, components *out);
components lower_tensor_binary(lowering *c, const expr *e, components a, components b);
/* Force state from `energy W` of a particle (IR_NONE after a message): bonds share it with the other side. */
ir_node lower_force_state_of_energy(lowering *c, ir_node W);

#endif
