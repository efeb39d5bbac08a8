#include "generator/lower/lower_tensor.h"

static bool is_shear(int k) {
  return k >= TENSOR_XY;
}

ir_node tensor_scaled(ir *g, ir_node factor, ir_node component) {
  return ir_is_number(g, component, 0) ? component : ir_mul(g, factor, component);
}

ir_node tensor_contract(ir *g, components a, components b) {
  ir_node sum = ir_constant(g, 0);
  for (int k = 0; k < a.count; k++) {
    ir_node term = ir_mul(g, a.of[k], b.of[k]);
    if (a.count == TENSOR_COUNT && is_shear(k)) term = ir_mul(g, ir_constant(g, 2), term);
    sum = ir_add(g, sum, term);
  }
  return sum;
}

ir_node tensor_trace(ir *g, components a) {
  ir_node plane = ir_add(g, a.of[TENSOR_XX], a.of[TENSOR_YY]);
  return ir_add(g, plane, a.of[TENSOR_ZZ]);
}

components tensor_deviator(ir *g, components a) {
  ir_node third = ir_div(g, tensor_trace(g, a), ir_constant(g, 3));
  for (int k = 0; k < TENSOR_XY; k++)
    a.of[k] = ir_sub(g, a.of[k], third);
  return a;
}

static ir_node root(ir *g, ir_node n) {
  return ir_unary(g, IR_SQRT, n);
}

ir_node tensor_J2(ir *g, components a) {
  components s = tensor_deviator(g, a);
  return half(g, tensor_contract(g, s, s));
}

/* The pair in the plane, and the third direction among them. */
static ir_node plane_principal(ir *g, components a, int which) {
  ir_node middle = half(g, ir_add(g, a.of[TENSOR_XX], a.of[TENSOR_YY]));
  ir_node difference = half(g, ir_sub(g, a.of[TENSOR_XX], a.of[TENSOR_YY]));
  ir_node square = ir_mul(g, difference, difference);
  ir_node radius = root(g, ir_add(g, square, ir_mul(g, a.of[TENSOR_XY], a.of[TENSOR_XY])));
  ir_node large = ir_add(g, middle, radius), small = ir_sub(g, middle, radius);
  ir_node third = a.of[TENSOR_ZZ];
  if (which == 1) return ir_binary(g, IR_MAX, large, third);
  if (which == 3) return ir_binary(g, IR_MIN, small, third);
  return ir_binary(g, IR_MAX, small, ir_binary(g, IR_MIN, large, third));
}

static ir_node determinant(ir *g, components a) {
  const ir_node *m = a.of;
  ir_node first =
      ir_sub(g, ir_mul(g, m[TENSOR_YY], m[TENSOR_ZZ]), ir_mul(g, m[TENSOR_YZ], m[TENSOR_YZ]));
  ir_node second =
      ir_sub(g, ir_mul(g, m[TENSOR_XY], m[TENSOR_ZZ]), ir_mul(g, m[TENSOR_YZ], m[TENSOR_XZ]));
  ir_node third =
      ir_sub(g, ir_mul(g, m[TENSOR_XY], m[TENSOR_YZ]), ir_mul(g, m[TENSOR_YY], m[TENSOR_XZ]));
  ir_node sum = ir_sub(g, ir_mul(g, m[TENSOR_XX], first), ir_mul(g, m[TENSOR_XY], second));
  return ir_add(g, sum, ir_mul(g, m[TENSOR_XZ], third));
}

/* Eigenvalues of a symmetric 3x3 tensor by the angle of its deviator (Smith 1961). */
static ir_node space_principal(ir *g, components a, int which) {
  ir_node mean = ir_div(g, tensor_trace(g, a), ir_constant(g, 3));
  components s = tensor_deviator(g, a);
  ir_node size = root(g, ir_div(g, tensor_contract(g, s, s), ir_constant(g, 6)));
  ir_node cube = ir_mul(g, ir_mul(g, size, size), size);
  ir_node safe = ir_binary(g, IR_MAX, ir_mul(g, ir_constant(g, 2), cube), ir_constant(g, 1e-290));
  ir_node ratio = ir_div(g, determinant(g, s), safe);
  ir_node cosine =
      ir_binary(g, IR_MAX, ir_binary(g, IR_MIN, ratio, ir_constant(g, 1)), ir_constant(g, -1));
  ir_node sine =
      root(g, ir_binary(g, IR_MAX, ir_sub(g, ir_constant(g, 1), ir_mul(g, cosine, cosine)),
                        ir_constant(g, 0)));
  ir_node angle = ir_div(g, ir_binary(g, IR_ATAN2, sine, cosine), ir_constant(g, 3));
  ir_node twice = ir_mul(g, ir_constant(g, 2), size);
  ir_node first = ir_add(g, mean, ir_mul(g, twice, ir_unary(g, IR_COS, angle)));
  ir_node turned = ir_add(g, angle, ir_constant(g, 2.0943951023931954923)); /* 2 pi/3 */
  ir_node last = ir_add(g, mean, ir_mul(g, twice, ir_unary(g, IR_COS, turned)));
  if (which == 1) return first;
  if (which == 3) return last;
  return ir_sub(g, ir_sub(g, ir_mul(g, ir_constant(g, 3), mean), first), last);
}

ir_node tensor_principal(ir *g, components a, int which) {
  bool plane = ir_is_number(g, a.of[TENSOR_YZ], 0) && ir_is_number(g, a.of[TENSOR_XZ], 0);
  return plane ? plane_principal(g, a, which) : space_principal(g, a, which);
}

/* Isotropic elasticity. In plane stress the third direction is free: sigma_zz = 0 whatever eps_zz
   says. */
components tensor_hooke(ir *g, law_setting setting, components eps, ir_node E, ir_node nu) {
  ir_node one = ir_constant(g, 1), two = ir_constant(g, 2);
  ir_node twice_mu = ir_div(g, E, ir_add(g, one, nu)), lambda, sum;
  if (setting == SETTING_PLANE_STRESS) {
    lambda = ir_div(g, ir_mul(g, E, nu), ir_sub(g, one, ir_mul(g, nu, nu)));
    sum = ir_add(g, eps.of[TENSOR_XX], eps.of[TENSOR_YY]);
  } else {
    ir_node below = ir_mul(g, ir_add(g, one, nu), ir_sub(g, one, ir_mul(g, two, nu)));
    lambda = ir_div(g, ir_mul(g, E, nu), below);
    sum = tensor_trace(g, eps);
  }
  ir_node pressure = ir_mul(g, lambda, sum);
  for (int k = 0; k < TENSOR_COUNT; k++) {
    eps.of[k] = tensor_scaled(g, twice_mu, eps.of[k]);
    if (k < TENSOR_XY) eps.of[k] = ir_add(g, pressure, eps.of[k]);
  }
  if (setting == SETTING_PLANE_STRESS) eps.of[TENSOR_ZZ] = ir_constant(g, 0);
  return eps;
}

components tensor_binary(lowering *c, const expr *e, components a, components b) {
  ir *g = c->graph;
  if (e->binary == OP_CONTRACT && a.count == b.count) return scalar(tensor_contract(g, a, b));
  bool scaled = a.count == 1 || b.count == 1;
  if (e->binary != OP_ADD && e->binary != OP_SUB && e->binary != OP_MUL && e->binary != OP_DIV)
    return lower_failed_value(c, e->where, "this cannot be done with tensors and vectors");
  if (scaled != (e->binary == OP_MUL || e->binary == OP_DIV))
    return lower_failed_value(c, e->where, "this cannot be done with tensors and vectors");
  components v = {a.count > b.count ? a.count : b.count, {0}};
  for (int k = 0; k < v.count; k++) {
    ir_node left = a.of[a.count == 1 ? 0 : k], right = b.of[b.count == 1 ? 0 : k];
    switch (e->binary) {
    case OP_ADD:
      v.of[k] = ir_add(g, left, right);
      break;
    case OP_SUB:
      v.of[k] = ir_sub(g, left, right);
      break;
    case OP_MUL:
      v.of[k] = a.count == 1 ? tensor_scaled(g, left, right) : tensor_scaled(g, right, left);
      break;
    default:
      v.of[k] = ir_is_number(g, left, 0) ? left : ir_div(g, left, right);
    }
  }
  return v;
}
