/* Stages of a loop over a strip of bonds: loops over the same bonds one after the other, with the
   values that later stages need kept in buffers in the first cache; the arrays of the results are
   the first of these, until the last stage writes what they are for. How a loop is cut:
   loop_cutting.h. What each stage computes, takes and keeps is said here.

       for part of 256 bonds
         stage 0: elongation, turned   -> force_0, kept[0]       chord_moves -> largest_0
         stage 1: theta_i, N           -> force_0, force_1
         where largest_0 is not below 1/16: these again, with both sides of the choice
         stage 2: force_0 ... force_3, new damage                where it changed -> changed
         stage 3, if changed: field_0, dissipated

   Where a value is chosen by a condition that is expected to hold (choices.h), stages compute what
   is expected for all bonds and gather the largest of the sizes that the conditions ask about.
   Of conditions that ask for no size a flag of each bond waits in a buffer of its own. Before the
   last stage, which overwrites fields, it is looked whether all were as expected; if not, bonds
   that exist and are not are looked for, vector by vector, and of what the last stage takes from
   buffers theirs is computed again with both sides, as far as it hangs on what was expected.

   What follows from new damage alone is left to one more stage, done only where a bond has some:
   most steps leave nearly all damage as it is, which need not be written then, and whose energy
   need not be computed.

   None of this changes any operation: results are the same to the bit, however a loop is cut. */
#ifndef PERILAT_GENERATOR_STAGES_H
#define PERILAT_GENERATOR_STAGES_H

#include "generator/target/choices.h"

enum { STAGES_PART = 256 /* bonds */ };
/* Doubles of a buffer; not near a part of 4 KiB: stores would hold up loads. */
#define STAGES_PITCH 280

typedef struct stage_cost {
  int operations, divisions, loads, stores;
  int chain;     /* cycles from the first load to the last result */
  double cycles; /* estimated, for eight bonds */
} stage_cost;

typedef struct stages {
  int count;
  int *of;     /* [node_count] stage that computes a node that has a line; -1: has none */
  int *buffer; /* [node_count] where it is kept for later stages; -1: it is not */
  int *until;  /* [node_count] last stage that it is kept for; -1 */
  int *result; /* [node_count] 1: a result of the pass; 2 + k: also of the k-th result array; 0 */
  int result_arrays; /* the first buffers are arrays of results; */
  int buffers;       /* so many stand behind them */
  bool changes;      /* one more stage is done only where some damage changed */
  int conditions;    /* expected ones */
  stage_cost *cost;  /* [count] */
  double cycles;     /* sum of the stages' */
  int whole_chain;   /* cycles of the chain of an uncut loop */
} stages;

void stages_free(stages *s);

/* An input that is neither number nor value of the whole strip; a node that is computed on a line
   of its own. */
bool stages_is_loaded(const emitter *e, ir_node n);
static inline bool stages_is_line(const emitter *e, ir_node n) {
  return e->name[n] && !expression_is_uniform(e, n) && !expression_is_of_time(e, n) &&
         ir_operation(e->graph, n) != IR_INPUT;
}
/* A result whose array is a buffer until the last stage writes it. */
bool stages_in_result_array(const segment_root *r);
/* A result of the stage behind the last, which most steps leave as it is nearly everywhere: damage,
   and energy that nothing but damage takes. */
bool stages_is_of_change(const emitter *e, const segment_root *r);

/* The stage that ends with what the pass gives, in every part. */
static inline int stages_last(const stages *s) {
  return s->count - 1 - s->changes;
}
/* Whether the pass gives a result in that stage: all in the last one but those of a change. New
   damage is asked for there, too. */
bool stages_give(const emitter *e, const stages *s, int stage, const segment_root *r);
/* Whether the stage takes a node from an earlier one. That of changes takes results from the one
   before it, and computes what else that has again: it is rare. */
static inline bool stages_take(const stages *s, ir_node n, int stage) {
  if (s->of[n] < 0 || s->of[n] >= stage) return false;
  return s->of[n] < stages_last(s) || s->result[n];
}
/* Whether a stage stores a line in a buffer; what is in the array of a result is a result. */
bool stages_store(const stages *s, ir_node n, int stage);
/* A choice by a condition that is expected to hold, the first to ask for it: later ones rely on the
   answer. */
bool stages_ask(const emitter *e, const stages *s, ir_node n);
bool stages_ask_for_protection(const emitter *e, const stages *s, int stage);
/* As choice_operands; what an earlier choice has asked is not asked again. */
int stages_operands(const emitter *e, const stages *s, ir_node n, unsigned relies,
                    ir_node operand[3]);
/* Marks what the loop of a stage computes or loads, and `kept_loads`, what it takes from the
   buffers; mask and kept_loads: [node_count], zeroed here. `relies`: on what (reliance). */
void stages_mark(const emitter *e, const stages *s, int stage, unsigned relies, unsigned char *mask,
                 unsigned char *kept_loads);
/* What the last stage, or that behind it, takes from a buffer: marks. */
void stages_mark_kept(const emitter *e, const stages *s, unsigned char *mask);

#endif
