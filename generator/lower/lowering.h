/* A law on its way to the graph: the values of its names so far, the first reason why it cannot be
   compiled, and what became of its text. */
#ifndef PERILAT_GENERATOR_LOWERING_H
#define PERILAT_GENERATOR_LOWERING_H

#include "generator/lower/lowered.h"

/* Expanding functions can grow a law without bound; these limits are far beyond any real one. */
enum { MOST_NODES = 150000, MOST_VISITS = 2000000, MOST_CALLS_DEEP = 64, CALL_BUCKETS = 256 };

enum { TENSOR_XX, TENSOR_YY, TENSOR_ZZ, TENSOR_XY, TENSOR_YZ, TENSOR_XZ, TENSOR_COUNT };
enum { GENERAL_COUNT = GENERAL_COMPONENT_COUNT };

/* A value: one node for a number, a truth value or a bending quantity (which has one component in a
   plane), three for a vector, six for a symmetric tensor (not engineering shear), nine for one that
   need not be symmetric (lower_general.h). A tensor whose trace is known to be 0 is a deviator: its
   zz is -(xx + yy) by construction. */
typedef struct components {
  int count;
  ir_node of[GENERAL_COUNT];
  bool traced; /* of a tensor: its trace is known without summing up */
  ir_node trace;
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
  const law_variation *variation;
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
/* Of `hooke`: a continuum has all three directions, in the plane, too. */
law_setting lower_hooke_setting(const lowering *c);

static inline ir_node half(ir *g, ir_node n) {
  return ir_mul(g, ir_constant(g, 0.5), n);
}
/* a b, without a node where one of them is 0. */
static inline ir_node product(ir *g, ir_node a, ir_node b) {
  if (ir_is_number(g, a, 0)) return a;
  return ir_is_number(g, b, 0) ? b : ir_mul(g, b, a);
}
static inline components scalar(ir_node n) {
  return (components){.count = 1, .of = {n}};
}

/* Parameter k, where it differs in space that of the particle or the bond. */
ir_node lower_own_parameter(const lowering *c, int k);

components *lower_binding_of(const lowering *c, const symbol *s);
void lower_bind(lowering *c, const symbol *s, components value);
/* Constants and inputs keep their own names. */
void lower_name_node(ir *g, ir_node n, const char *name, span where);
void lower_name_value(lowering *c, components value, const char *name, span where);

/* What stands in the text, for checks of it: noted by LOWER_STEP. */
void lower_note_place(lowering *c, ir_node n, const expr *e);
void lower_note_line(lowering *c, const expr *cases, int line, ir_node guard);
/* Of LOWER_STEP alone. */
void lower_note_flow(lowering *c, const stmt *rule, ir_node when, ir_node overstress);

#endif
