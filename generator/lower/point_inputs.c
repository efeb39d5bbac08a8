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

/* Which input each of the quantities is that laws of cracks have. */
static int tip_input_of(builtin_quantity q) {
  switch (q) {
  case QUANTITY_K_I:
    return TIP_K_I;
  case QUANTITY_K_II:
    return TIP_K_II;
  case QUANTITY_ENERGY_RELEASE:
    return TIP_ENERGY_RELEASE;
  case QUANTITY_ANGLE_NOW:
    return TIP_ANGLE;
  case QUANTITY_SPEED_NOW:
    return TIP_SPEED;
  case QUANTITY_RAYLEIGH_SPEED:
    return TIP_RAYLEIGH_SPEED;
  case QUANTITY_SHEAR_SPEED:
    return TIP_SHEAR_SPEED;
  case QUANTITY_DILATATIONAL_SPEED:
    return TIP_DILATATIONAL_SPEED;
  default:
    return TIP_LENGTH;
  }
}

ir_node lower_tip_quantity(ir *g, builtin_quantity q) {
  return ir_input(g, IR_FROM_TIP, tip_input_of(q), builtin_quantities[q].name, ON_TIP);
}
