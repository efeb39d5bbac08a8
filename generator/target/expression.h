/* Nodes of the graph as C: which of them get a line and a name, and the text of each, with the
   parentheses that keep the graph's order of operations. Where inputs come from is the business of
   the loop's form (scope).

       law                              C
       e = stretch - strain_0           const double e = stretch - strain_0; (line 7)
       N = E*A*e when e < e_max         N = e < e_max ? EA*e : 0.0
           0 otherwise

   A node has a line if it has a name in the law, if two others use it, or if what stands in its
   place would be long; E*A is the same for all bonds: `prepare` computes it, and the loop finds it
   among its `uniforms`. */
#ifndef PERILAT_GENERATOR_EXPRESSION_H
#define PERILAT_GENERATOR_EXPRESSION_H

#include "generator/plan/plan.h"
#include "generator/target/c_text.h"
#include "generator/target/kernel_parts.h"
#include "generator/target/words.h"

typedef struct emitter emitter;

/* What the lines of a function depend on, beside the graph. */
typedef struct scope {
  const char *before, *indent; /* indentation before the loop and in it */
  word uniform;                /* where values are that `prepare` has computed; SAY_NOTHING: here */
  bool strip; /* each case of a chain has its line, and what is expected is asked by sizes */
  /* Writes what stands before the loop for an input; may be NULL. */
  void (*declare)(emitter *e, ir_node input);
  /* What the line of an input says, or of a search, whose result the form finds. */
  const char *(*input)(emitter *e, ir_node input);
} scope;

/* What a loop over bonds relies on: of choices by it only what it says is computed. */
typedef enum reliance {
  RELIES_ON_NOTHING = 0,
  RELIES_ON_EXPECTED = 1,   /* conditions that are expected to hold do */
  RELIES_ON_UNPROTECTED = 2 /* no bond is protected */
} reliance;

struct emitter {
  const kernel_plan *plan;
  const ir *graph;
  c_text *out;
  arena *memory; /* of texts */
  int node_count;
  int *uniform_of;        /* [node_count] index in `uniforms`, or -1 */
  unsigned char *of_time; /* [node_count] expression_is_of_time */
  kernel_parts parts;

  /* the function or the segment that is written */
  const scope *scope;
  void *form;                /* the form's own; forms cast it back */
  const segment_root *roots; /* [root_count] of a segment */
  int root_count;
  unsigned relies; /* reliance, together */
  c_names names;
  unsigned char *needed;  /* [node_count] */
  unsigned char *dropped; /* [node_count] lines that are 0 where the bond is absent; or NULL */
  int *uses;              /* [node_count] by needed nodes and roots */
  ir_node *user;          /* [node_count] the last of them; IR_NONE: a root */
  int *size;              /* [node_count] operations written in place of the node */
  const char **name;      /* [node_count] NULL: written in place */
  ir_node *order;         /* [node_count] in which lines stand; NULL: as in the graph */
};

/* Adds a word with its pieces to the text; the same as a text that lives as long as the emitter. */
#define say(e, ...)   words_add((e)->out, WORDS_OF(__VA_ARGS__))
#define spell(e, ...) words_text((e)->memory, WORDS_OF(__VA_ARGS__))
/* A number as a piece. */
const char *numeral(const emitter *e, int number);

void emitter_begin(emitter *e, const kernel_plan *plan, c_text *out);
void emitter_end(emitter *e);

/* Begins and ends a function that computes these nodes, or those of a segment: decides which get a
   line and a name. */
void expression_open(emitter *e, const scope *in, const ir_node *nodes, int count);
void expression_open_segment(emitter *e, const scope *in, const segment *a);
void expression_close(emitter *e);

/* A value loaded from `uniforms`; in `prepare` the same node is computed. */
static inline bool expression_is_uniform(const emitter *e, ir_node n) {
  return e->scope->uniform != SAY_NOTHING && e->uniform_of[n] >= 0;
}
static inline bool expression_is_input(const emitter *e, ir_node n) {
  return ir_operation(e->graph, n) == IR_INPUT && !expression_is_uniform(e, n);
}
bool expression_is_ends_input(const emitter *e, ir_node n, ends_input which);
/* The time step or `dt`, or what follows from these and from values of all bonds alone: one number
   of the whole record, known before the loop. */
static inline bool expression_is_of_time(const emitter *e, ir_node n) {
  return e->of_time[n];
}
/* How a form reads the time step and `dt`. */
const char *expression_time(emitter *e, ir_node n, word time_step, word advance);
/* Whether the function needs an input from there. */
bool expression_reads(const emitter *e, ir_source from);
/* Whether node n, a condition, is that a bond of a strip is protected. */
bool expression_asks_protected(const emitter *e, ir_node n);

/* Whether node n, a choice, is written as the smaller or the larger of two, without its condition.
 */
bool expression_is_extreme(const emitter *e, ir_node n);

/* Node n as an operand of a choice, as all of a statement's value, as a condition. */
const char *expression_value(const emitter *e, ir_node n);
const char *expression_whole(const emitter *e, ir_node n);
const char *expression_condition(const emitter *e, ir_node n);
/* `; / * line 12 * /` and the end of the line. */
const char *expression_line_end(const emitter *e, ir_node n);

/* What stands before the loop: values that are the same for all bonds, and the arrays of the
   others. */
void expression_declare(emitter *e);
/* The line of a value of time that is no input. */
void expression_line_of_time(emitter *e, ir_node n, const char *indent);
/* The node whose line is the k-th. */
static inline ir_node expression_in_order(const emitter *e, int k) {
  return e->order ? e->order[k] : k;
}
/* `const double x = ...;` for a node that has a name in the loop; for each of them, in order. */
void expression_line(emitter *e, ir_node n);
void expression_lines(emitter *e);

/* NULL without such a root. */
const segment_root *expression_find_root(const emitter *e, segment_target target, int index);

#endif
