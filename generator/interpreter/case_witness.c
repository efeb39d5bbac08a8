#include "generator/interpreter/case_witness.h"

#include <stdlib.h>
#include <string.h>

#include "generator/interpreter/guard_watch.h"
#include "generator/interpreter/interpreted.h"

enum { SEEN_FALSE = 1, SEEN_TRUE = 2, IS_CASE = 4, IS_MOTION = 8 };

struct case_witness {
  const pl_law *kernel;
  const ir *graph;
  int count;            /* nodes */
  unsigned char *marks; /* [count] */
  ir_node *choices;     /* [choice_count] that are cases of the law, where they are computed */
  int choice_count;
  /* [count] of a choice that is a branch of one other choice alone, and nothing else: that one;
     else IR_NONE */
  ir_node *above;
  ir_node *user; /* [count] the first node that needs it, or IR_NONE */
};

/* The choices that stand in one branch of another one, as the cases behind a first one do. */
static void find_branches(case_witness *w) {
  const ir *g = w->graph;
  int *uses = must_calloc((size_t)w->count + 1, sizeof *uses);
  for (ir_node n = 0; n < w->count; n++)
    w->above[n] = w->user[n] = IR_NONE;
  for (ir_node n = 0; n < w->count; n++)
    for (int k = 0; k < ir_arity(ir_operation(g, n)); k++) {
      const ir_node of = ir_operand(g, n, k);
      uses[of]++;
      if (w->user[of] == IR_NONE) w->user[of] = n;
      if (ir_operation(g, n) == IR_SELECT && k > 0) w->above[of] = n;
    }
  for (ir_node n = 0; n < w->count; n++)
    if (uses[n] != 1 || ir_operation(g, n) != IR_SELECT) w->above[n] = IR_NONE;
  free(uses);
}

/* Does a node depend on what is the law's own: its states and parameters? */
static bool *find_own(const case_witness *w) {
  const ir *g = w->graph;
  const int parameters = w->kernel->parameter_count;
  bool *own = must_calloc((size_t)w->count + 1, sizeof *own);
  for (ir_node n = 0; n < w->count; n++) {
    if (ir_operation(g, n) == IR_INPUT) {
      const ir_source from = ir_input_source(g, n);
      own[n] = from == IR_FROM_FIELD || from == IR_FROM_NEW_FIELD ||
               (from == IR_FROM_PARAMETER && ir_input_index(g, n) < parameters);
    }
    for (int k = 0; k < ir_arity(ir_operation(g, n)); k++)
      own[n] = own[n] || own[ir_operand(g, n, k)];
  }
  return own;
}

/* What the motion of a bond is computed with is no case of the law: it has names, no lines, and
   nothing of the law's own. */
static void find_motion(case_witness *w) {
  const ir *g = w->graph;
  ir_node *roots = must_calloc((size_t)w->count + 1, sizeof *roots);
  unsigned char *needed = must_calloc((size_t)w->count + 1, 1);
  bool *own = find_own(w);
  int count = 0;
  for (ir_node n = 0; n < w->count; n++)
    if (ir_name(g, n) && ir_where(g, n).end == 0 && ir_operation(g, n) != IR_INPUT && !own[n])
      roots[count++] = n;
  ir_mark(g, roots, count, needed);
  for (ir_node n = 0; n < w->count; n++)
    if (needed[n]) w->marks[n] |= IS_MOTION;
  free(roots);
  free(needed);
  free(own);
}

/* Is the choice asked in this state: do those above it take the branch that it is? */
static bool is_asked(const case_witness *w, const interpreter *p, ir_node n, int lane) {
  for (ir_node up = w->above[n]; up != IR_NONE; n = up, up = w->above[n]) {
    const double *guard = interpreter_lanes(p, ir_operand(w->graph, up, 0));
    const int branch = guard && guard[lane] != 0 ? 1 : 2;
    if (!guard || ir_operand(w->graph, up, branch) != n) return false;
  }
  return true;
}

/* Damage that a deck holds back is none of the law's cases. */
static bool asks_for_protection(const ir *g, ir_node choice) {
  const ir_node guard = ir_operand(g, choice, 0);
  for (int k = 0; k < ir_arity(ir_operation(g, guard)); k++) {
    const char *name = ir_name(g, ir_operand(g, guard, k));
    if (name && strncmp(name, "protected", strlen("protected")) == 0) return true;
  }
  return false;
}

static void find_choices(case_witness *w) {
  const ir *g = w->graph;
  w->choices = must_calloc((size_t)w->count + 1, sizeof *w->choices);
  for (ir_node n = 0; n < w->count; n++)
    if (ir_operation(g, n) == IR_SELECT && !(w->marks[n] & IS_MOTION) && choice_is_case(g, n) &&
        !asks_for_protection(g, n))
      w->choices[w->choice_count++] = n;
}

/* Of laws of bonds the first state alone is a bond; others are lanes without one. */
static void look(void *context, const interpreter *p, int count) {
  case_witness *w = context;
  const ir *g = w->graph;
  const int lanes = w->kernel->kind == PL_STATE ? count : 1;
  for (int c = 0; c < w->choice_count; c++) {
    const ir_node n = w->choices[c];
    if (!interpreter_lanes(p, n)) continue;
    const double *guard = interpreter_lanes(p, ir_operand(g, n, 0));
    w->marks[n] |= IS_CASE;
    for (int k = 0; k < lanes; k++)
      if (guard && is_asked(w, p, n, k)) w->marks[n] |= guard[k] != 0 ? SEEN_TRUE : SEEN_FALSE;
  }
}

case_witness *case_witness_begin(const pl_law *kernel) {
  case_witness *w = must_calloc(1, sizeof *w);
  w->kernel = kernel;
  w->graph = plan_of_interpreted(kernel)->graph;
  w->count = ir_count(w->graph);
  w->marks = must_calloc((size_t)w->count + 1, 1);
  w->above = must_calloc((size_t)w->count + 1, sizeof *w->above);
  w->user = must_calloc((size_t)w->count + 1, sizeof *w->user);
  find_branches(w);
  find_motion(w);
  find_choices(w);
  plan_interpreted_watch(kernel, look, w);
  return w;
}

static case_seen *seen_of(cases_seen *seen, int choice, span where) {
  for (int k = 0; k < seen->count; k++)
    if (seen->items[k].choice == choice) return &seen->items[k];
  seen->items = must_realloc(seen->items, ((size_t)seen->count + 1) * sizeof *seen->items);
  seen->items[seen->count] = (case_seen){.choice = choice, .where = where};
  return &seen->items[seen->count++];
}

/* The place of the value that a choice goes into. */
static span place_of(const case_witness *w, ir_node n) {
  enum { FARTHEST = 40 };
  for (int k = 0; k < FARTHEST && n != IR_NONE; k++, n = w->user[n])
    if (ir_where(w->graph, n).end > 0) return ir_where(w->graph, n);
  return (span){0, 0, 0};
}

void case_witness_end(case_witness *w, cases_seen *seen) {
  plan_interpreted_watch(w->kernel, NULL, NULL);
  for (ir_node n = 0; n < w->count; n++) {
    if (!(w->marks[n] & IS_CASE)) continue;
    const span where = place_of(w, n);
    if (where.end == 0) continue; /* of a sum over neighbours, say: not the law's */
    case_seen *one = seen_of(seen, n, where);
    one->was_true = one->was_true || w->marks[n] & SEEN_TRUE;
    one->was_false = one->was_false || w->marks[n] & SEEN_FALSE;
  }
  free(w->marks);
  free(w->choices);
  free(w->above);
  free(w->user);
  free(w);
}
