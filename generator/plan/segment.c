#include "generator/plan/segment.h"

#include <stdlib.h>
#include <string.h>

#include "generator/lower/kinematics.h"

/* --- roots ------------------------------------------------------------------------------------ */

void segment_add(arena *memory, segment *a, segment_root root) {
  if (a->root_count == a->root_capacity) {
    const int capacity = a->root_capacity ? 2 * a->root_capacity : 8;
    segment_root *roots = arena_alloc(memory, (size_t)capacity * sizeof *roots);
    if (a->root_count) memcpy(roots, a->roots, (size_t)a->root_count * sizeof *roots);
    a->roots = roots;
    a->root_capacity = capacity;
  }
  a->roots[a->root_count++] = root;
}

int segment_value_count(const segment *a) {
  int count = a->root_count;
  for (int k = 0; k < a->root_count; k++)
    count += segment_has_far(&a->roots[k]);
  return count;
}

ir_node *segment_values(const segment *a) {
  ir_node *values = must_alloc((2 * (size_t)a->root_count + 1) * sizeof *values);
  for (int k = 0, far = a->root_count; k < a->root_count; k++) {
    values[k] = a->roots[k].node;
    if (segment_has_far(&a->roots[k])) values[far++] = a->roots[k].far;
  }
  return values;
}

void segment_replace(segment *a, const ir_node *values) {
  for (int k = 0, far = a->root_count; k < a->root_count; k++) {
    a->roots[k].node = values[k];
    if (segment_has_far(&a->roots[k])) a->roots[k].far = values[far++];
  }
}

unsigned char *segment_needed(const ir *g, const segment *a) {
  unsigned char *needed = must_calloc((size_t)ir_count(g) + 1, 1);
  ir_node *values = segment_values(a);
  ir_mark(g, values, segment_value_count(a), needed);
  free(values);
  return needed;
}

/* --- sums of products ------------------------------------------------------------------------- */

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
  if (r->target != TO_SUM || ir_operation(g, r->node) != IR_MUL || ir_is_uniform(g, r->node) ||
      segment_has_far(r))
    return false;
  return r->over != OVER_PAIRS || is_finite(g, ir_operand(g, r->node, 0)) ||
         is_finite(g, ir_operand(g, r->node, 1));
}

int segment_nodes(const ir *g, const segment *a, ir_node *nodes) {
  int count = a->root_count;
  for (int k = 0; k < a->root_count; k++) {
    const segment_root *r = &a->roots[k];
    nodes[k] = r->node;
    if (segment_has_far(r)) nodes[count++] = r->far;
    if (!segment_fuses(g, r)) continue;
    const int second = r->over != OVER_PAIRS || is_finite(g, ir_operand(g, r->node, 1));
    nodes[k] = ir_operand(g, r->node, 1 - second);
    nodes[count++] = ir_operand(g, r->node, second);
  }
  return count;
}
