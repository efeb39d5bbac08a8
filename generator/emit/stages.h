/* Cuts the loop over a strip of bonds into stages, loops over the same bonds one after the other, with the values that
   later stages need kept in buffers in the first cache; the arrays of the results are the first of these, until the last
   stage writes what they are for.

   Why: a processor keeps some hundred operations in flight. Where those of one bond wait for each other in a long chain,
   few bonds are in flight at once, and the processor waits with them; of short chains it overlaps many. And where a value
   is chosen by a condition that is expected to hold (ir_expect), stages compute what is expected for all bonds and gather
   the largest of the sizes that the conditions ask about. Before the last stage, which overwrites fields, it is looked
   whether all were as expected; if not, bonds that exist and are not are looked for, vector by vector, and theirs is
   computed again with both sides, all that the last stage takes from buffers. Where a strip says that none of its bonds
   is protected, what protected ones keep is not looked at.

   What follows from new damage alone is left to one more stage, done only where a bond has some: most steps leave nearly
   all damage as it is, which need not be written then, and whose energy need not be computed.

   None of this changes any operation: results are the same to the bit, however a loop is cut. */
#ifndef PERILAT_GENERATOR_STAGES_H
#define PERILAT_GENERATOR_STAGES_H

#include "generator/emit/emit_parts.h"

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
  int *
      result; /* [node_count] 1: a result of the pass; 2 + k: also the k-th array that is lent; 0 */
  int lent;    /* the first buffers are arrays of results; */
  int buffers; /* so many stand behind them */
  bool changes;     /* one more stage is done only where some damage changed */
  int conditions;   /* expected ones */
  stage_cost *cost; /* [count] */
  double cycles;    /* sum of the stages' */
  int whole_chain;  /* cycles of the chain of an uncut loop */
} stages;

/* For the pass that the emitter has open, by estimated cost; `cutting` may forbid or force cuts. */
stages *stages_plan(const emitter *e, loop_cutting cutting);
void stages_free(stages *s);

/* A condition that is expected of the bonds of a strip: that a size is below a positive limit. */
typedef struct expectation {
  ir_node size[2]; /* [count]; of two the larger absolute value is meant */
  int count;
  ir_node limit;
} expectation;

/* Two sizes are asked for together where the limit is 2: the highest bit of the exponent tells. */
expectation stages_expectation(const emitter *e, ir_node condition);
/* Operands of node n, operand[3]; in a loop that relies on what is expected, of a choice by an expected condition only
   the value it is expected to choose and what the condition asks about, and where no bond is protected, only what others
   get. Returns their number. */
int stages_operands(const emitter *e, ir_node n, unsigned relies, ir_node operand[3]);
/* Marks what the loop of a stage computes or loads, and `kept_loads`, what it takes from the buffers; mask and kept_loads:
   [node_count], zeroed here. `relies`: on what (reliance). */
void stages_mark(const emitter *e, const stages *s, int stage, unsigned relies, unsigned char *mask,
                 unsigned char *kept_loads);
/* A choice by a condition that is expected to hold. */
bool stages_is_expected_choice(const emitter *e, ir_node n);
/* A line that is a choice by whether a bond is protected, of which strips say when none is: then its last operand. */
bool stages_is_held_choice(const emitter *e, ir_node n);
bool stages_has_held_choices(const emitter *e, const stages *s, int stage);
/* The stage that ends with what the pass gives, in every part. */
int stages_last(const stages *s);
/* A result of the stage behind that, which most steps leave as it is nearly everywhere: damage, and energy that nothing but
   damage takes. */
bool stages_is_of_change(const emitter *e, const pass_root *r);
/* A choice by a condition that is expected to hold, the first to ask for it: later ones rely on the answer. */
bool stages_asks(const emitter *e, const stages *s, ir_node n);
/* Whether a stage stores a line in a buffer; what is in the array of a result is a result. */
bool stages_stores(const stages *s, ir_node n, int stage);
/* What the last stage, or that behind it, takes from a buffer: marks. */
void stages_mark_kept(const emitter *e, const stages *s, unsigned char *mask);
/* A result whose array is a buffer until the last stage writes it. */
bool stages_is_lent(const pass_root *r);

#endif
