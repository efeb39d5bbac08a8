#include "generator/lower/lower_tensor.h"

#include <string.h>

#include "generator/lower/lower_general.h"

static bool is_shear(int k) {
  return k >= TENSOR_XY;
}

bool tensor_is_deviator(const ir *g, const components *a) {
  return a->traced && ir_is_number(g, a->trace, 0);
}

components tensor_as_deviator(ir *g, components a) {
  a.of[TENSOR_ZZ] = ir_neg(g, ir_add(g, a.of[TENSOR_XX], a.of[TENSOR_YY]));
  a.traced = true;
  a.trace = ir_constant(g, 0);
  return a;
}

components tensor_settled(ir *g, components a) {
  if (tensor_is_deviator(g, &a)) return tensor_as_deviator(g, a);
  a.traced = false;
  return a;
}

ir_node tensor_scaled(ir *g, ir_node factor, ir_node component) {
  return ir_is_number(g, component, 0) ? component : ir_mul(g, factor, component);
}

static bool are_same(const components *a, const components *b) {
  return memcmp(a->of, b->of, sizeof a->of) == 0;
}

ir_node tensor_contract(ir *g, components a, components b) {
  if (a.count == GENERAL_COUNT || b.count == GENERAL_COUNT) return general_contract(g, a, b);
  if (tensor_is_deviator(g, &a) && are_same(&a, &b)) return ir_scaled(g, 2, tensor_J2(g, a));
  ir_node sum = ir_constant(g, 0);
  for (int k = 0; k < a.count; k++) {
    ir_node term = ir_mul(g, a.of[k], b.of[k]);
    if (a.count == TENSOR_COUNT && is_shear(k)) term = ir_mul(g, ir_constant(g, 2), term);
    sum = ir_add(g, sum, term);
  }
  return sum;
}

ir_node tensor_trace(ir *g, components a) {
  if (a.traced) return a.trace;
  ir_node plane = ir_add(g, a.of[TENSOR_XX], a.of[TENSOR_YY]);
  return ir_add(g, plane, a.of[TENSOR_ZZ]);
}

components tensor_deviator(ir *g, components a) {
  if (tensor_is_deviator(g, &a)) return a;
  const ir_node three = ir_constant(g, 3), third = ir_div(g, tensor_trace(g, a), three);
  for (int k = 0; k < TENSOR_ZZ; k++)
    a.of[k] = ir_sub(g, a.of[k], third);
  return tensor_as_deviator(g, a);
}

static ir_node root(ir *g, ir_node n) {
  return ir_unary(g, IR_SQRT, n);
}

/* Half of the deviator's square: xx (xx + yy) + yy^2 and the squares of the shears. */
ir_node tensor_J2(ir *g, components a) {
  const components s = tensor_deviator(g, a);
  const ir_node xx = s.of[TENSOR_XX], yy = s.of[TENSOR_YY];
  ir_node sum = ir_mul(g, yy, yy);
  sum = ir_add(g, ir_mul(g, xx, ir_add(g, xx, yy)), sum);
  for (int k = TENSOR_XY; k < TENSOR_COUNT; k++)
    sum = ir_add(g, sum, ir_mul(g, s.of[k], s.of[k]));
  return sum;
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

/* a b - c d */
static ir_node minor_of(ir *g, ir_node a, ir_node b, ir_node c, ir_node d) {
  const ir_node less = ir_mul(g, c, d);
  return ir_sub(g, ir_mul(g, a, b), less);
}

static ir_node determinant(ir *g, components a) {
  const ir_node *m = a.of;
  const ir_node first = minor_of(g, m[TENSOR_YY], m[TENSOR_ZZ], m[TENSOR_YZ], m[TENSOR_YZ]),
                second = minor_of(g, m[TENSOR_XY], m[TENSOR_ZZ], m[TENSOR_YZ], m[TENSOR_XZ]),
                third = minor_of(g, m[TENSOR_XY], m[TENSOR_YZ], m[TENSOR_YY], m[TENSOR_XZ]);
  const ir_node sum = minor_of(g, m[TENSOR_XX], first, m[TENSOR_XY], second);
  return ir_add(g, sum, ir_mul(g, m[TENSOR_XZ], third));
}

/* Eigenvalues of a symmetric 3x3 tensor by the angle of its deviator (Smith 1961). */
static ir_node space_principal(ir *g, components a, int which) {
  const ir_node three = ir_constant(g, 3), mean = ir_div(g, tensor_trace(g, a), three);
  components s = tensor_deviator(g, a);
  const ir_node six = ir_constant(g, 6);
  ir_node size = root(g, ir_div(g, tensor_contract(g, s, s), six));
  ir_node cube = ir_mul(g, ir_mul(g, size, size), size);
  const ir_node least = ir_constant(g, 1e-290);
  ir_node safe = ir_binary(g, IR_MAX, ir_scaled(g, 2, cube), least);
  ir_node ratio = ir_div(g, determinant(g, s), safe);
  const ir_node back = ir_constant(g, -1), one = ir_constant(g, 1);
  ir_node cosine = ir_binary(g, IR_MAX, ir_binary(g, IR_MIN, ratio, one), back);
  const ir_node zero = ir_constant(g, 0), square = ir_mul(g, cosine, cosine);
  ir_node sine = root(g, ir_binary(g, IR_MAX, ir_sub(g, one, square), zero));
  ir_node angle = ir_div(g, ir_binary(g, IR_ATAN2, sine, cosine), three);
  ir_node twice = ir_scaled(g, 2, size);
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
    const ir_node below = ir_sub(g, one, ir_mul(g, nu, nu));
    lambda = ir_div(g, ir_mul(g, E, nu), below);
    sum = ir_add(g, eps.of[TENSOR_XX], eps.of[TENSOR_YY]);
  } else {
    const ir_node less = ir_sub(g, one, ir_mul(g, two, nu));
    const ir_node below = ir_mul(g, ir_add(g, one, nu), less);
    lambda = ir_div(g, ir_mul(g, E, nu), below);
    sum = tensor_trace(g, eps);
  }
  ir_node pressure = ir_mul(g, lambda, sum);
  components sigma = {.count = TENSOR_COUNT};
  for (int k = 0; k < TENSOR_COUNT; k++) {
    sigma.of[k] = tensor_scaled(g, twice_mu, eps.of[k]);
    if (k < TENSOR_XY) sigma.of[k] = ir_add(g, pressure, sigma.of[k]);
  }
  if (setting == SETTING_PLANE_STRESS) sigma.of[TENSOR_ZZ] = ir_constant(g, 0);
  return sigma;
}

/* `a op b` of one component, or of the trace; a product of a number and a component. */
static ir_node linear(ir *g, binary_op op, ir_node a, ir_node b, bool number_first) {
  switch (op) {
  case OP_ADD:
    return ir_add(g, a, b);
  case OP_SUB:
    return ir_sub(g, a, b);
  case OP_MUL:
    return number_first ? tensor_scaled(g, a, b) : tensor_scaled(g, b, a);
  default:
    return ir_is_number(g, a, 0) ? a : ir_div(g, a, b);
  }
}

/* The trace of `v`, which is a op b: known where that of one operand is and the other is a number,
   a deviator or known as well. */
static components with_trace(ir *g, binary_op op, const components *a, const components *b,
                             components v) {
  const bool scaled = a->count == 1 || b->count == 1;
  v.traced = scaled
                 ? a->traced || b->traced
                 : (a->traced && b->traced) || tensor_is_deviator(g, a) || tensor_is_deviator(g, b);
  if (!v.traced) return v;
  const ir_node left = a->count == TENSOR_COUNT ? tensor_trace(g, *a) : a->of[0],
                right = b->count == TENSOR_COUNT ? tensor_trace(g, *b) : b->of[0];
  v.trace = linear(g, op, left, right, a->count == 1);
  return tensor_is_deviator(g, &v) ? tensor_as_deviator(g, v) : v;
}

components tensor_binary(lowering *c, const expr *e, components a, components b) {
  ir *g = c->graph;
  const bool tensors = a.count >= TENSOR_COUNT && b.count >= TENSOR_COUNT;
  if (e->binary == OP_CONTRACT && (tensors || a.count == b.count))
    return scalar(tensor_contract(g, a, b));
  bool scaled = a.count == 1 || b.count == 1;
  if (e->binary == OP_MUL && !scaled && a.count >= TENSOR_COUNT) return general_product(g, a, b);
  if (tensors && a.count != b.count) a = general_of(g, a), b = general_of(g, b);
  if (e->binary != OP_ADD && e->binary != OP_SUB && e->binary != OP_MUL && e->binary != OP_DIV)
    return lower_failed_value(c, e->where, "this cannot be done with tensors and vectors");
  if (scaled != (e->binary == OP_MUL || e->binary == OP_DIV))
    return lower_failed_value(c, e->where, "this cannot be done with tensors and vectors");
  components v = {.count = a.count > b.count ? a.count : b.count};
  for (int k = 0; k < v.count; k++)
    v.of[k] =
        linear(g, e->binary, a.of[a.count == 1 ? 0 : k], b.of[b.count == 1 ? 0 : k], a.count == 1);
  return with_trace(g, e->binary, &a, &b, v);
}
