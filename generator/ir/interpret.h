/* The second reader of the IR: evaluates a graph with the same operations, in the same order and
   with the same elementary functions as the emitted C, for many states at a time. */
#ifndef PERILAT_GENERATOR_INTERPRET_H
#define PERILAT_GENERATOR_INTERPRET_H

#include "generator/ir/ir.h"

#define INTERPRET_LANES 64 /* states evaluated together */

typedef struct interpreter interpreter;

/* Prepares to evaluate `roots` (none of them IR_NONE). The graph must outlive the interpreter and
   may grow. Reductions over the family and IR_NEIGHBOUR are no operations on numbers: programs of
   families (program.h) have neither, a root that does fails an assertion. An interpreter serves one
   thread at a time. */
interpreter *interpreter_new(const ir *g, const ir_node *roots, int root_count);
void interpreter_free(interpreter *p);

/* Inputs: values[source][index] points at the first of `count` values, `stride[source][index]`
   apart (0: one value for all). Sources or inputs that the roots do not need may be NULL. */
typedef struct interpreter_inputs {
  const double *const *values[IR_SOURCE_COUNT];
  const unsigned char *stride[IR_SOURCE_COUNT]; /* 0 or 1 for each index; NULL: all 0 */
} interpreter_inputs;

/* outputs[k][0..count) receives root k. Any count; no allocation. */
void interpreter_run(interpreter *p, const interpreter_inputs *in, int count,
                     double *const *outputs);
/* After a run of at most INTERPRET_LANES states, whose outputs may be NULL: the values [count] of
   root k, until the next run. */
const double *interpreter_root(const interpreter *p, int root);

/* From here on called after the states of each run, at most INTERPRET_LANES of them at a time, were
   evaluated; NULL: nothing is. */
typedef void interpreter_look(void *context, const interpreter *p, int count);
void interpreter_watch(interpreter *p, interpreter_look *look, void *context);
/* Values [count] of node `n` then; NULL where the roots do not need it. */
const double *interpreter_lanes(const interpreter *p, ir_node n);

/* After interpreter_run with count = 1: the first node, in evaluation order, that is not finite, or
   IR_NONE. interpreter_value is what node `n`, needed by the roots, had. */
ir_node interpreter_first_bad(const interpreter *p);
double interpreter_value(const interpreter *p, ir_node n);

#endif
