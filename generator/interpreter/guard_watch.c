#include "generator/interpreter/guard_watch.h"

#include <assert.h>
#include <stdlib.h>

#include "dsl/base/arena.h"

enum { GUARD = 2 /* a mark beside those of ir_mark */, SEEN_FALSE = 1, SEEN_TRUE = 2 };

struct guard_watch {
  interpreter *interpreter; /* NULL without guards */
  int count;
  int most;                 /* states at once */
  double *memory, **values; /* [count][most] */
  unsigned char *seen;      /* [count] */
};

/* a < b ? b : a and the like. */
static bool is_limit(const ir *g, ir_node choice) {
  ir_node guard = ir_operand(g, choice, 0);
  ir_node yes = ir_operand(g, choice, 1), no = ir_operand(g, choice, 2);
  if (ir_arity(ir_operation(g, guard)) != 2) return false;
  ir_node a = ir_operand(g, guard, 0), b = ir_operand(g, guard, 1);
  return (yes == a && no == b) || (yes == b && no == a);
}

/* x == x: is it a number? No condition of the law. */
static bool asks_for_number(const ir *g, ir_node guard) {
  return ir_operation(g, guard) == IR_EQ && ir_operand(g, guard, 0) == ir_operand(g, guard, 1);
}

bool choice_is_case(const ir *g, ir_node choice) {
  const ir_node guard = ir_operand(g, choice, 0);
  return !is_limit(g, choice) && !ir_is_uniform(g, guard) && !asks_for_number(g, guard);
}

static int find_guards(const kernel_plan *p, ir_node *guards) {
  const ir *g = p->graph;
  const int nodes = ir_count(g);
  if (p->form != FORM_STRIPS) return 0;
  unsigned char *marks = segment_needed(g, plan_segment(p, PROGRAM_STATES));
  for (ir_node n = 0; n < nodes; n++)
    if (marks[n] && ir_operation(g, n) == IR_SELECT && choice_is_case(g, n))
      marks[ir_operand(g, n, 0)] = GUARD;
  int count = 0;
  for (ir_node n = 0; n < nodes; n++)
    if (marks[n] == GUARD) guards[count++] = n;
  free(marks);
  return count;
}

guard_watch *guard_watch_new(const kernel_plan *p, int most) {
  guard_watch *w = must_calloc(1, sizeof *w);
  ir_node *guards = must_calloc((size_t)ir_count(p->graph) + 1, sizeof *guards);
  w->most = most;
  w->count = find_guards(p, guards);
  if (w->count) w->interpreter = interpreter_new(p->graph, guards, w->count);
  size_t room = (size_t)w->count + 1;
  w->memory = must_calloc(room * (size_t)most, sizeof *w->memory);
  w->values = must_calloc(room, sizeof *w->values);
  w->seen = must_calloc(room, 1);
  for (int k = 0; k < w->count; k++)
    w->values[k] = w->memory + (long)k * most;
  free(guards);
  return w;
}

void guard_watch_free(guard_watch *w) {
  interpreter_free(w->interpreter);
  free(w->memory);
  free(w->values);
  free(w->seen);
  free(w);
}

void guard_watch_see(guard_watch *w, const interpreter_inputs *in, int count) {
  assert(count <= w->most);
  if (w->count) interpreter_run(w->interpreter, in, count, w->values);
  for (int k = 0; k < w->count; k++)
    for (int q = 0; q < count; q++)
      w->seen[k] |= w->values[k][q] != 0 ? SEEN_TRUE : SEEN_FALSE;
}

int guard_watch_count(const guard_watch *w) {
  return w->count;
}

int guard_watch_both(const guard_watch *w) {
  int both = 0;
  for (int k = 0; k < w->count; k++)
    both += w->seen[k] == (SEEN_TRUE | SEEN_FALSE);
  return both;
}
