#include "generator/plan/segment.h"

#include "generator/lower/kinematics.h"

/* A constant of the class, or a sum of such and of displacements. */
static bool is_finite(const ir *g, ir_node n) {
  const ir_op op = ir_operation(g, n);
  if (ir_is_uniform(g, n)) return true;
  if (op == IR_ADD || op == IR_SUB)
    return is_finite(g, ir_operand(g, n, 0)) && is_finite(g, ir_operand(g, n, 1));
  return op == IR_INPUT && ir_input_source(g, n) == IR_FROM_ENDS &&
         ends_origins[ir_input_index(g, n)].array == FROM_DISPLACEMENT;
}

bool segment_fuses(const ir *g, const segment_root *r) {
  if (r->target != TO_SUM || ir_operation(g, r->node) != IR_MUL || ir_is_uniform(g, r->node))
    return false;
  return !r->paired || is_finite(g, ir_operand(g, r->node, 0)) ||
         is_finite(g, ir_operand(g, r->node, 1));
}

int segment_nodes(const ir *g, const segment *a, ir_node *nodes) {
  int count = a->root_count;
  for (int k = 0; k < a->root_count; k++) {
    const segment_root *r = &a->roots[k];
    nodes[k] = r->node;
    if (!segment_fuses(g, r)) continue;
    const int second = !r->paired || is_finite(g, ir_operand(g, r->node, 1));
    nodes[k] = ir_operand(g, r->node, 1 - second);
    nodes[count++] = ir_operand(g, r->node, second);
  }
  return count;
}
