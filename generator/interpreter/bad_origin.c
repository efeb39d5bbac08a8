#include "generator/interpreter/bad_origin.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/lower/lower.h"

/* The first operand of a node that is not finite, of a choice the one that is chosen. */
static ir_node bad_operand(const ir *g, const interpreter *p, ir_node n) {
  const ir_op op = ir_operation(g, n);
  int from = 0, to = ir_arity(op);
  if (op == IR_SELECT) {
    from = interpreter_value(p, ir_operand(g, n, 0)) != 0 ? 1 : 2;
    to = from + 1;
  }
  for (int k = from; k < to; k++)
    if (!isfinite(interpreter_value(p, ir_operand(g, n, k)))) return ir_operand(g, n, k);
  return IR_NONE;
}

static ir_node origin_of(const ir *g, const interpreter *p, ir_node n) {
  for (ir_node next = n; next != IR_NONE; next = bad_operand(g, p, n))
    n = next;
  return n;
}

/* Of a return that is not found the lowering makes the root of -1 (lower.c). */
static bool is_return(const ir *g, ir_node n) {
  if (ir_operation(g, n) != IR_SQRT) return false;
  const ir_node of = ir_operand(g, n, 0);
  return ir_operation(g, of) == IR_SELECT && ir_is_number(g, ir_operand(g, of, 2), -1);
}

static bad_origin origin_in_text(const ir *g, const interpreter *p, const lowered_law *step,
                                 ir_node n) {
  bad_origin found = {is_return(g, n) ? BAD_RETURN : BAD_OTHER, NULL};
  const lowered_text *t = &step->text;
  if (ir_operation(g, n) != IR_DIV || interpreter_value(p, ir_operand(g, n, 1)) != 0) return found;
  for (int k = 0; k < t->place_count; k++) {
    const expr *of = t->places[k].of;
    if (t->places[k].node == n && of->kind == EXPR_BINARY && of->binary == OP_DIV)
      found = (bad_origin){BAD_DIVISION, of};
  }
  return found;
}

static bad_origin origin_among(const ir *g, const lowered_law *step, const ir_node *roots,
                               int count, const interpreter_inputs *in) {
  double *values = must_calloc((size_t)count, sizeof *values),
         **at = must_calloc((size_t)count, sizeof *at);
  for (int k = 0; k < count; k++)
    at[k] = &values[k];
  interpreter *p = interpreter_new(g, roots, count);
  interpreter_run(p, in, 1, at);
  bad_origin found = {BAD_NOWHERE, NULL};
  for (int k = 0; k < count && found.kind == BAD_NOWHERE; k++)
    if (!isfinite(values[k])) found = origin_in_text(g, p, step, origin_of(g, p, roots[k]));
  interpreter_free(p);
  free(at);
  free(values);
  return found;
}

bad_origin bad_origin_of_point(const law *l, const interpreter_inputs *in) {
  arena *memory = arena_new();
  ir *graph = ir_new();
  diagnostics said = {0};
  lowered_law step;
  bad_origin found = {BAD_NOWHERE, NULL};
  if (lower_law(l, graph, LOWER_STEP, memory, &step, &said)) {
    const int fields = l->fields.count;
    ir_node *roots = arena_alloc(memory, (size_t)(fields + LOWERED_STRESSES) * sizeof *roots);
    int count = 0;
    for (int k = 0; k < fields; k++)
      roots[count++] = step.fields[k];
    for (int k = 0; k < LOWERED_STRESSES; k++)
      if (step.sigma[k] != IR_NONE) roots[count++] = step.sigma[k];
    if (count > 0) found = origin_among(graph, &step, roots, count, in);
  }
  ir_free(graph);
  arena_free(memory);
  diag_clear(&said);
  return found;
}
