#include "generator/lower/lower_inputs.h"

#include "generator/lower/kinematics.h"
#include "generator/lower/law_inputs.h"
#include "runtime/kernel.h"

ir_node lower_quantity(ir *g, builtin_quantity q) {
  /* Of the number of bonds, too, a kernel knows the value of its bond class only (a full family).
   */
  placement on = law_motion_place(q) >= 0 || q == QUANTITY_TWIST ? ON_BOND : ON_BODY;
  ir_node n = ir_input(g, IR_FROM_QUANTITY, (int)q, builtin_quantities[q].name, on);
  return builtin_quantities[q].place == ON_BOND ? ir_mark_class(g, n) : n;
}

ir_node lower_advance(ir *g, const law *l) {
  if (l->tree->law == LAW_STATE) return kinematics_advance(g, ON_PARTICLE);
  if (l->tree->law == LAW_CONTINUUM) return kinematics_advance(g, ON_POINT);
  return lower_quantity(g, QUANTITY_DT);
}

ir_node lower_bending(ir *g, const law *l, builtin_quantity theta, int axis) {
  static const char *const names[2][BENDING_AXES] = {{"theta_ix", "theta_iy", "theta_iz"},
                                                     {"theta_jx", "theta_jy", "theta_jz"}};
  const int end = theta == QUANTITY_THETA_J;
  if (!l->bends_in_space) return lower_quantity(g, theta);
  return ir_input(g, IR_FROM_QUANTITY, QUANTITY_COUNT + BENDING_AXES * end + axis, names[end][axis],
                  ON_BOND);
}

ir_node lower_parameter(ir *g, const law *l, int k) {
  return ir_input(g, IR_FROM_PARAMETER, k, l->parameters.items[k]->name, ON_BODY);
}

ir_node lower_varying(ir *g, const law *l, const law_variation *v, int k) {
  const law_kind kind = l->tree->law;
  return ir_input(g, kind == LAW_STATE ? IR_FROM_PARTICLE_PARAMETER : IR_FROM_BOND_PARAMETER, k,
                  l->parameters.items[v->varying[k]]->name,
                  kind == LAW_CONTINUUM ? ON_POINT
                  : kind == LAW_STATE   ? ON_PARTICLE
                                        : ON_BOND);
}

ir_node lower_field(ir *g, const law *l, int k) {
  return ir_input(g, IR_FROM_FIELD, k, l->fields.items[k]->name, l->fields.items[k]->place);
}

bool lower_is_returned(const symbol *s) {
  return s->rule && s->rule->kind == STMT_FLOW && s->rule->returned;
}

bool lower_is_solved(const symbol *s) {
  return s->rule && !s->rate_of && (s->rule->kind == STMT_RATE || lower_is_returned(s));
}

ir_node lower_kept_field(ir *g, const law *l, int k) {
  return ir_input(g, IR_FROM_FIELD, -1 - k, l->fields.items[k]->name, l->fields.items[k]->place);
}

ir_node lower_volume(ir *g, const law *l) {
  return l->irregular ? kinematics_input(g, ENDS_VOLUME_I) : lower_quantity(g, QUANTITY_V);
}

ir_node lower_own_size(ir *g, const law *l, builtin_quantity q) {
  ir_node size = kinematics_input(g, ENDS_SIZE_I);
  if (l->tree->law != LAW_STATE)
    size = ir_scaled(g, 0.5, ir_add(g, size, kinematics_input(g, ENDS_SIZE_J)));
  return ir_mul(g, size, lower_quantity(g, q));
}

ir_node lower_inverse_shape(ir *g, const law *l, int row, int column) {
  static const char *const names[] = {
      "shape_0",  "shape_1",  "shape_2",  "shape_3",  "shape_4",  "shape_5",  "shape_6",
      "shape_7",  "shape_8",  "shape_9",  "shape_10", "shape_11", "shape_12", "shape_13",
      "shape_14", "shape_15", "shape_16", "shape_17", "shape_18", "shape_19", "shape_20"};
  int size = lower_dimensions(l) == 2 ? 3 : 6; /* strains */
  int r = row < column ? row : column, q = row < column ? column : row;
  int at = r * size - r * (r - 1) / 2 + (q - r);
  return ir_input(g, IR_FROM_SHAPE, at, names[at], ON_PARTICLE);
}

ir_node lower_resolved(ir *g, const law *l) {
  return ir_input(g, IR_FROM_SHAPE, PL_SHAPE_VALUES(lower_dimensions(l)), "resolved", ON_PARTICLE);
}
