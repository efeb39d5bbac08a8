/* Which cases of a law its states reached: the conditions seen true and those seen false. */
#ifndef PERILAT_GENERATOR_GUARD_WATCH_H
#define PERILAT_GENERATOR_GUARD_WATCH_H

#include "generator/lower/law_inputs.h"
#include "generator/plan/plan.h"

typedef struct guard_watch guard_watch;

/* Does this choice (IR_SELECT) decide between cases of the law, by the state? */
bool choice_is_case(const ir *g, ir_node choice);

/* Watches every condition that decides between cases and depends on the state, not on parameters
   alone. A limit put on a value ("the larger of a and b") decides nothing. `most`: states that it
   is shown at once. */
guard_watch *guard_watch_new(const kernel_plan *p, int most);
void guard_watch_free(guard_watch *w);
void guard_watch_see(guard_watch *w, const interpreter_inputs *in, int count);
int guard_watch_count(const guard_watch *w);
int guard_watch_both(const guard_watch *w); /* seen true and seen false */

#endif
