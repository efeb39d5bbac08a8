#include "generator/lower/lower_rest.h"

#include "generator/ir/rewrite.h"
#include "generator/lower/lower_inputs.h"

void rest_take_off(ir *g, const lowered_law *of, ir_node *nodes, int count) {
  if (of->rest == IR_NONE) return;
  const ir_node stretch = lower_quantity(g, QUANTITY_STRETCH),
                measured = ir_sub(g, stretch, of->rest);
  for (int k = 0; k < count; k++)
    if (nodes[k] != IR_NONE) ir_substitute(g, &nodes[k], 1, &stretch, &measured, 1, &nodes[k]);
}

ir_node rest_stand_in(ir *g, const law *l) {
  return ir_input(g, IR_FROM_FIELD, l->fields.count, "rest", ON_BOND);
}

void rest_hold(ir *g, const law *l, const lowered_law *of, ir_node *node) {
  lowered_law held = *of;
  if (of->rest != IR_NONE) held.rest = rest_stand_in(g, l);
  rest_take_off(g, &held, node, 1);
}

ir_node rest_filled_in(ir *g, const law *l, ir_node rest, ir_node node) {
  if (rest == IR_NONE || node == IR_NONE) return node;
  const ir_node from = rest_stand_in(g, l);
  ir_substitute(g, &node, 1, &from, &rest, 1, &node);
  return node;
}

void rest_take_off_law(ir *g, const law *l, lowered_law *of) {
  ir_node *forces[LOWERED_FORCES];
  const int count = lowered_forces(of, forces);
  for (int k = 0; k < count; k++)
    rest_take_off(g, of, forces[k], 1);
  rest_take_off(g, of, &of->W, 1);
  rest_take_off(g, of, of->fields, l->fields.count);
  rest_take_off(g, of, of->outputs, l->outputs.count);
}

bool rest_reads_states(ir *g, const law *l, const ir_node *rest, int rests) {
  bool found = false;
  for (int k = 0; k < l->fields.count && rests > 0 && !found; k++) {
    const ir_node field = lower_field(g, l, k);
    found = rewrite_depends(g, rest, rests, &field, 1);
  }
  return found;
}
