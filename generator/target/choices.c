#include "generator/target/choices.h"

#include <assert.h>

bool choice_is_expected(const emitter *e, ir_node n) {
  return ir_is_expected_choice(e->graph, n) && !expression_is_uniform(e, n) &&
         !expression_is_of_time(e, n);
}

bool choice_is_by_protection(const emitter *e, ir_node n) {
  return e->name[n] && ir_operation(e->graph, n) == IR_SELECT &&
         expression_asks_protected(e, ir_operand(e->graph, n, 0));
}

expectation choice_expectation(const emitter *e, ir_node condition) {
  const ir *g = e->graph;
  if (!ir_is_expected_of_size(g, condition)) return (expectation){.count = 0, .limit = IR_NONE};
  assert(ir_operation(g, condition) == IR_LT);
  const ir_node size = ir_operand(g, condition, 0), limit = ir_operand(g, condition, 1);
  expectation x = {{size, IR_NONE}, 1, limit};
  const bool is_two = ir_operation(g, limit) == IR_CONSTANT && ir_value(g, limit) == 2;
  if (!is_two || ir_operation(g, size) != IR_MAX) return x;
  for (int k = 0; k < 2; k++) {
    const ir_node one = ir_operand(g, size, k);
    if (ir_operation(g, one) != IR_ABS) return (expectation){{size, IR_NONE}, 1, limit};
    x.size[k] = ir_operand(g, one, 0);
  }
  x.count = 2;
  return x;
}

/* The value first. */
static int operands_of_expected(const emitter *e, ir_node n, ir_node operand[3]) {
  operand[0] = ir_operand(e->graph, n, 1);
  if (!e->scope->strip) {
    operand[1] = ir_operand(e->graph, n, 0);
    return 2;
  }
  const expectation x = choice_expectation(e, ir_operand(e->graph, n, 0));
  for (int k = 0; k < x.count; k++)
    operand[1 + k] = x.size[k];
  if (x.count == 0) operand[1] = ir_operand(e->graph, n, 0);
  return 1 + (x.count ? x.count : 1);
}

int choice_operands(const emitter *e, ir_node n, unsigned relies, ir_node operand[3]) {
  const bool before = expression_is_uniform(e, n) || expression_is_of_time(e, n);
  int count = before ? 0 : ir_arity(ir_operation(e->graph, n));
  if ((relies & RELIES_ON_EXPECTED) && choice_is_expected(e, n))
    return operands_of_expected(e, n, operand);
  if ((relies & RELIES_ON_UNPROTECTED) && choice_is_by_protection(e, n)) {
    operand[0] = ir_operand(e->graph, n, 2);
    return 1;
  }
  /* The smaller or the larger of two does not read the condition. In strips one without a line of
     its own is counted as part of the choice. */
  const bool extreme = count == 3 && expression_is_extreme(e, n);
  const int first = extreme && (!e->scope->strip || e->name[ir_operand(e->graph, n, 0)]);
  for (int k = first; k < count; k++)
    operand[k - first] = ir_operand(e->graph, n, k);
  return count - first;
}

void choice_mark_operands(const emitter *e, unsigned relies, unsigned char *mask) {
  for (ir_node n = e->node_count - 1; n >= 0; n--) {
    ir_node operand[3];
    const int count = mask[n] ? choice_operands(e, n, relies, operand) : 0;
    for (int k = 0; k < count; k++)
      mask[operand[k]] = 1;
  }
}
