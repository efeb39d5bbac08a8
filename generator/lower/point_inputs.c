#include "generator/lower/point_inputs.h"

#include "generator/lower/lower_inputs.h"
#include "generator/lower/lowering.h"

int point_component(int dimensions, int at) {
  static const int of_plane[] = {TENSOR_XX, TENSOR_YY, TENSOR_XY, TENSOR_ZZ};
  return dimensions == 2 ? of_plane[at] : at;
}

ir_node point_input_node(ir *g, int input) {
  static const char *const names[POINT_INPUTS] = {
      "strain_xx", "strain_yy", "strain_zz", "strain_xy", "strain_yz", "strain_xz", "rate_xx",
      "rate_yy",   "rate_zz",   "rate_xy",   "rate_yz",   "rate_xz",   "h"};
  return ir_input(g, IR_FROM_POINT, input, names[input], ON_POINT);
}

ir_node lower_point_strain(ir *g, const law *l, int k, bool rate) {
  if (lower_dimensions(l) == 2 && (k == TENSOR_YZ || k == TENSOR_XZ)) return ir_constant(g, 0);
  return point_input_node(g, (rate ? POINT_STRAIN_RATE : POINT_STRAIN) + k);
}

_Static_assert(QUANTITY_DILATATIONAL_SPEED - QUANTITY_K_I + 1 == TIP_INPUTS,
               "quantities of tips stand in the order of their inputs");

ir_node lower_tip_quantity(ir *g, builtin_quantity q) {
  return ir_input(g, IR_FROM_TIP, (int)(q - QUANTITY_K_I), builtin_quantities[q].name, ON_TIP);
}
