#include "generator/lower/lower_solved.h"

#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/ir/rewrite.h"

int lower_freeze_neighbours(lowering *c, ir_node *n, ir_node **what, ir_node **stand_in) {
  ir *g = c->graph;
  const int nodes = ir_count(g), fields = c->law->fields.count;
  unsigned char *marks = must_calloc((size_t)nodes + 1, 1);
  int count = 0;
  ir_mark(g, n, 1, marks);
  for (ir_node k = 0; k < nodes; k++)
    count += marks[k] && ir_operation(g, k) == IR_NEIGHBOUR;
  *what = arena_alloc(c->memory, ((size_t)count + 1) * sizeof **what);
  *stand_in = arena_alloc(c->memory, ((size_t)count + 1) * sizeof **stand_in);
  count = 0;
  for (ir_node k = 0; k < nodes; k++) {
    if (!marks[k] || ir_operation(g, k) != IR_NEIGHBOUR) continue;
    (*what)[count] = k;
    (*stand_in)[count] = ir_input(g, IR_FROM_FIELD, 2 * fields + 1 + k, "frozen", ir_place(g, k));
    count++;
  }
  free(marks);
  ir_substitute(g, n, 1, *what, *stand_in, count, n);
  return count;
}

bool lower_moves_a_sum(const ir *g, ir_node over, ir_node lambda) {
  unsigned char *marks = must_calloc((size_t)ir_count(g) + 1, 1);
  bool found = false;
  ir_mark(g, &over, 1, marks);
  for (ir_node n = 0; n <= over && !found; n++)
    found =
        marks[n] && ir_is_reduction(ir_operation(g, n)) && rewrite_depends(g, &n, 1, &lambda, 1);
  free(marks);
  return found;
}

ir_node lower_zero_if(ir *g, ir_node good) {
  const ir_node zero = ir_constant(g, 0), bad = ir_constant(g, -1);
  return ir_unary(g, IR_SQRT, ir_select(g, good, zero, bad));
}
