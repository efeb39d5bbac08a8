#include "generator/lower/principal_axes.h"

#include "generator/lower/lower_tensor.h"

/* Where a tensor's component of two axes stands. */
static const int place_of[3][3] = {{TENSOR_XX, TENSOR_XY, TENSOR_XZ},
                                   {TENSOR_XY, TENSOR_YY, TENSOR_YZ},
                                   {TENSOR_XZ, TENSOR_YZ, TENSOR_ZZ}};

static components number_tensor(ir *g, double xx, double yy, double zz) {
  const ir_node zero = ir_constant(g, 0);
  return (components){
      .count = TENSOR_COUNT,
      .of = {ir_constant(g, xx), ir_constant(g, yy), ir_constant(g, zz), zero, zero, zero}};
}

static components chosen(ir *g, ir_node when, components a, components b) {
  for (int k = 0; k < TENSOR_COUNT; k++)
    a.of[k] = ir_select(g, when, a.of[k], b.of[k]);
  return a;
}

static components difference(ir *g, components a, components b) {
  for (int k = 0; k < TENSOR_COUNT; k++)
    a.of[k] = ir_sub(g, a.of[k], b.of[k]);
  return a;
}

static components scaled(ir *g, components a, ir_node by) {
  for (int k = 0; k < TENSOR_COUNT; k++)
    a.of[k] = tensor_scaled(g, by, a.of[k]);
  return a;
}

/* 1/x, where x is too small for one that of 1. */
static ir_node inverse(ir *g, ir_node x) {
  const ir_node safe = ir_binary(g, IR_MAX, x, ir_constant(g, 1e-290));
  return ir_div(g, ir_constant(g, 1), safe);
}

static ir_node both(ir *g, ir_node a, ir_node b) {
  return ir_is_number(g, a, 0) ? a : tensor_scaled(g, a, b);
}

components tensor_product(ir *g, components a, components b) {
  components v = {.count = TENSOR_COUNT};
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) {
      ir_node sum = ir_constant(g, 0);
      for (int k = 0; k < 3; k++) {
        sum = ir_add(g, sum, both(g, a.of[place_of[i][k]], b.of[place_of[k][j]]));
        sum = ir_add(g, sum, both(g, b.of[place_of[i][k]], a.of[place_of[k][j]]));
      }
      v.of[place_of[i][j]] = tensor_scaled(g, ir_constant(g, 0.5), sum);
    }
  return v;
}

/* --- in the plane ----------------------------------------------------------------------------- */

/* In the plane (I + D/r)/2 is the direction of the larger value, with D the deviator there and r
   its size; where that is 0, the direction is x. */
static components larger_of_plane(ir *g, components a, ir_node *large, ir_node *small) {
  const ir_node middle = half(g, ir_add(g, a.of[TENSOR_XX], a.of[TENSOR_YY]));
  const ir_node d = half(g, ir_sub(g, a.of[TENSOR_XX], a.of[TENSOR_YY])), s = a.of[TENSOR_XY];
  const ir_node square = ir_mul(g, s, s);
  const ir_node r = ir_unary(g, IR_SQRT, ir_add(g, ir_mul(g, d, d), square));
  const ir_node some = ir_binary(g, IR_LT, ir_constant(g, 1e-145), r), by = inverse(g, r);
  components n = number_tensor(g, 0, 0, 0);
  const ir_node cosine = ir_mul(g, d, by), one = ir_constant(g, 1);
  n.of[TENSOR_XX] = half(g, ir_add(g, one, cosine));
  n.of[TENSOR_YY] = half(g, ir_sub(g, one, cosine));
  n.of[TENSOR_XY] = half(g, ir_mul(g, s, by));
  *large = ir_add(g, middle, r);
  *small = ir_sub(g, middle, r);
  return chosen(g, some, n, number_tensor(g, 1, 0, 0));
}

static components plane_direction(ir *g, components a, int which) {
  ir_node large, small;
  const ir_node third = a.of[TENSOR_ZZ];
  const components first = larger_of_plane(g, a, &large, &small),
                   second = difference(g, number_tensor(g, 1, 1, 0), first),
                   out = number_tensor(g, 0, 0, 1);
  const ir_node is_first = ir_binary(g, IR_LT, large, third),
                is_last = ir_binary(g, IR_LT, third, small);
  if (which == 1) return chosen(g, is_first, out, first);
  if (which == 3) return chosen(g, is_last, out, second);
  return chosen(g, is_first, first, chosen(g, is_last, second, out));
}

/* --- in space --------------------------------------------------------------------------------- */

/* Of a - value I the matrix of its minors: a multiple of n n where `value` is a principal one. */
static components minors(ir *g, components a, ir_node value) {
  for (int k = 0; k < 3; k++)
    a.of[k] = ir_sub(g, a.of[k], value);
  components v = {.count = TENSOR_COUNT};
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) {
      const int p = (i + 1) % 3, q = (i + 2) % 3, r = (j + 1) % 3, s = (j + 2) % 3;
      const ir_node less = ir_mul(g, a.of[place_of[p][s]], a.of[place_of[q][r]]);
      v.of[place_of[i][j]] = ir_sub(g, ir_mul(g, a.of[place_of[p][r]], a.of[place_of[q][s]]), less);
    }
  return v;
}

/* m e/|m e| as a dyad, with e the axis along which the dyad m is longest. */
static components unit_dyad(ir *g, components m) {
  components v = number_tensor(g, 1, 0, 0);
  ir_node longest = IR_NONE;
  for (int axis = 0; axis < 3; axis++) {
    ir_node n[3], square = ir_constant(g, 0);
    for (int i = 0; i < 3; i++) {
      n[i] = m.of[place_of[i][axis]];
      square = ir_add(g, square, ir_mul(g, n[i], n[i]));
    }
    components here = {.count = TENSOR_COUNT};
    const ir_node by = inverse(g, square);
    for (int i = 0; i < 3; i++)
      for (int j = i; j < 3; j++)
        here.of[place_of[i][j]] = ir_mul(g, ir_mul(g, n[i], n[j]), by);
    const ir_node longer = longest == IR_NONE ? ir_binary(g, IR_LT, ir_constant(g, 1e-145), square)
                                              : ir_binary(g, IR_LT, longest, square);
    v = chosen(g, longer, here, v);
    longest = longest == IR_NONE ? square : ir_binary(g, IR_MAX, longest, square);
  }
  return v;
}

/* The value that stands farthest from the two others is the first where the determinant of the
   deviator s is positive, else the last. Its direction follows from the minors; across it the two
   others are told as in the plane. */
static components space_direction(ir *g, components a, int which) {
  const ir_node zero = ir_constant(g, 0);
  components whole = tensor_deviator(g, a);
  whole.traced = false; /* so that what is done below to components is done to all six */
  /* of size 1, so that squares and products stay numbers */
  ir_node size = ir_constant(g, 0);
  for (int k = 0; k < TENSOR_COUNT; k++)
    size = ir_binary(g, IR_MAX, size, ir_unary(g, IR_ABS, whole.of[k]));
  const components s = scaled(g, whole, inverse(g, size));
  const ir_node first = tensor_principal(g, s, 1), last = tensor_principal(g, s, 3);
  const ir_node is_first = ir_binary(g, IR_LE, zero, ir_add(g, first, last));
  const ir_node apart = ir_select(g, is_first, first, last);
  const components n = unit_dyad(g, minors(g, s, apart)),
                   across = difference(g, number_tensor(g, 1, 1, 1), n);
  const ir_node middle = ir_mul(g, ir_constant(g, -0.5), apart);
  const components in_plane = scaled(g, across, middle);
  const components d = difference(g, difference(g, s, scaled(g, n, apart)), in_plane);
  const ir_node r = ir_unary(g, IR_SQRT, half(g, tensor_contract(g, d, d)));
  const ir_node told = ir_binary(g, IR_LT, ir_constant(g, 1e-13), r);
  components large = scaled(g, d, inverse(g, r));
  for (int k = 0; k < TENSOR_COUNT; k++)
    large.of[k] = half(g, ir_add(g, across.of[k], large.of[k]));
  large = unit_dyad(g, chosen(g, told, large, across));
  const components small = difference(g, across, large);
  if (which == 1) return chosen(g, is_first, n, large);
  if (which == 3) return chosen(g, is_first, small, n);
  return chosen(g, is_first, large, small);
}

components tensor_direction(ir *g, components a, int which) {
  const bool plane = ir_is_number(g, a.of[TENSOR_YZ], 0) && ir_is_number(g, a.of[TENSOR_XZ], 0);
  return plane ? plane_direction(g, a, which) : space_direction(g, a, which);
}
