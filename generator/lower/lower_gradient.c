#include "generator/lower/lower_gradient.h"

#include "generator/lower/kinematics.h"
#include "generator/lower/lower_family.h"
#include "generator/lower/lower_general.h"
#include "generator/lower/lower_inputs.h"

enum { AXES = VECTOR_COMPONENT_COUNT };

components lower_displacement(ir *g, const law *l) {
  static const ends_input u[AXES] = {ENDS_U_IX, ENDS_U_IY, ENDS_U_IZ};
  components v = {.count = AXES};
  for (int d = 0; d < AXES; d++)
    v.of[d] = d < lower_dimensions(l) ? kinematics_input(g, u[d]) : ir_constant(g, 0);
  return v;
}

/* X_j, m; what leaves the plane is 0. */
static components reference_bond(ir *g, const law *l) {
  static const ends_input chord[AXES] = {ENDS_CLASS_CHORD_X, ENDS_CLASS_CHORD_Y,
                                         ENDS_CLASS_CHORD_Z};
  components v = {.count = AXES};
  for (int d = 0; d < AXES; d++)
    v.of[d] = d < lower_dimensions(l) ? kinematics_input(g, chord[d]) : ir_constant(g, 0);
  return v;
}

/* w_j V_j, m^3 */
static ir_node volume_weight(ir *g, const law *l, ir_node weight) {
  const ir_node V = lower_neighbour(g, scalar(lower_volume(g, l))).of[0];
  return weight == IR_NONE ? V : ir_mul(g, weight, V);
}

static ir_node sum_over_family(ir *g, ir_node n) {
  return ir_is_number(g, n, 0) ? n : ir_unary(g, IR_FAMILY_SUM, n);
}

/* K^-1, 1/m^5; 0 where K is not resolved, and what leaves the plane. */
static components inverse_shape(ir *g, const law *l, ir_node weight) {
  static const double RESOLVED = 1e-3;
  const components X = reference_bond(g, l);
  const int dimensions = lower_dimensions(l);
  const ir_node w = volume_weight(g, l, weight);
  components K = {.count = TENSOR_COUNT}, v = {.count = TENSOR_COUNT};
  for (int r = 0; r < AXES; r++)
    for (int c = r; c < AXES; c++) {
      const ir_node square = product(g, X.of[r], X.of[c]);
      K.of[general_place(r, c)] = sum_over_family(g, product(g, w, square));
    }
  ir_node mean = ir_add(g, K.of[TENSOR_XX], K.of[TENSOR_YY]);
  if (dimensions == 3) mean = ir_add(g, mean, K.of[TENSOR_ZZ]);
  mean = ir_scaled(g, 1.0 / dimensions, mean);
  if (dimensions == 2) K.of[TENSOR_ZZ] = ir_constant(g, 1);
  const ir_node determinant = general_determinant(g, K), zero = ir_constant(g, 0);
  const ir_node alike = ir_power(g, mean, ir_constant(g, dimensions));
  const ir_node least = ir_scaled(g, RESOLVED, alike);
  const ir_node resolved = ir_binary(g, IR_LT, least, determinant), one = ir_constant(g, 1);
  const ir_node quotient = ir_div(g, one, ir_select(g, resolved, determinant, one));
  const ir_node per_determinant = ir_select(g, resolved, quotient, zero);
  for (int k = 0; k < TENSOR_COUNT; k++)
    v.of[k] = zero;
  for (int r = 0; r < dimensions; r++)
    for (int c = r; c < dimensions; c++)
      v.of[general_place(r, c)] = ir_mul(g, general_cofactor(g, &K, r, c), per_determinant);
  return v;
}

/* sum(w_j V_j (a_j - a) X_j) K^-1, of one component. */
static components gradient_of(ir *g, const components *X, const components *inverse, ir_node w,
                              ir_node difference) {
  components sums = {.count = AXES};
  for (int d = 0; d < AXES; d++)
    sums.of[d] = sum_over_family(g, product(g, product(g, w, X->of[d]), difference));
  return general_product(g, *inverse, sums);
}

components lower_gradient(ir *g, const law *l, components value, ir_node weight) {
  const components X = reference_bond(g, l), inverse = inverse_shape(g, l, weight);
  const components other = lower_neighbour(g, value);
  const ir_node w = volume_weight(g, l, weight);
  components v = {.count = GENERAL_COUNT};
  for (int r = 0; r < value.count; r++) {
    const ir_node difference = ir_sub(g, other.of[r], value.of[r]);
    const components row = gradient_of(g, &X, &inverse, w, difference);
    if (value.count == 1) return row;
    for (int c = 0; c < AXES; c++)
      v.of[general_place(r, c)] = row.of[c];
  }
  return v;
}

/* 2 V P K^-1 is the particle's. */
components lower_correspondence(ir *g, const law *l, components P, ir_node weight) {
  const components inverse = inverse_shape(g, l, weight), X = reference_bond(g, l);
  const ir_node twice = ir_scaled(g, 2, lower_volume(g, l));
  components of_particle = general_product(g, general_of(g, P), inverse);
  for (int k = 0; k < GENERAL_COUNT; k++)
    of_particle.of[k] = product(g, twice, of_particle.of[k]);
  components F = general_product(g, of_particle, X);
  const ir_node w = volume_weight(g, l, weight);
  for (int d = 0; d < AXES; d++)
    F.of[d] = product(g, w, F.of[d]);
  return F;
}
