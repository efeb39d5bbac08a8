/* The conditions of a law's text, of its case lines and then of its flows: which depend on the
   state, and how each was seen. */
#ifndef PERILAT_GENERATOR_PHYSICS_CONDITIONS_H
#define PERILAT_GENERATOR_PHYSICS_CONDITIONS_H

#include "generator/check/physics.h"
#include "generator/lower/lowered.h"

typedef struct law_conditions {
  const lowered_text *text;
  int count;             /* lines, then flows */
  ir_node *node;         /* [count]; IR_NONE: it always holds */
  unsigned char *varies; /* [count] with the state */
  unsigned char *seen;   /* [count] 1: false, 2: true */
  unsigned char *taken;  /* [lines] a state was in this line: it was the first that held */
  unsigned char *shut;   /* [lines] an option or the lattice has chosen a line above it */
} law_conditions;

/* Of a text whose nodes are of graph g; the arrays live in `memory`. */
law_conditions conditions_new(const lowered_text *t, const ir *g, arena *memory);

static inline void conditions_see(law_conditions *all, int k, bool holds) {
  all->seen[k] |= holds ? 2 : 1;
}

/* The conditions in one state: holds[k][lane] of condition k. Which lines are taken there. */
void conditions_take(law_conditions *all, double *const *holds, int lane);

/* The first line whose guard varies, and that no state was in, in any call of its function; NULL
   where there is none. */
const lowered_line *conditions_never_taken(const law_conditions *all);

/* Those of one line count once, however often its function is called. */
void conditions_count(const law_conditions *all, physics_report *report);

#endif
