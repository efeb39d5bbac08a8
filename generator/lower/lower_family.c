#include "generator/lower/lower_family.h"

#include <string.h>

#include "generator/lower/kinematics.h"
#include "generator/lower/lower_general.h"
#include "generator/lower/lower_inputs.h"
#include "generator/lower/lower_tensor.h"
#include "generator/lower/principal_axes.h"

/* --- families --------------------------------------------------------------------------------- */

static bool is_plane(const law *l) {
  return lower_dimensions(l) == 2;
}

static ir_node neighbour_of(ir *g, ir_node n) {
  const bool of_body = ir_is_uniform(g, n) && !ir_is_of_class(g, n);
  return of_body ? n : ir_unary(g, IR_NEIGHBOUR, n);
}

components lower_neighbour(ir *g, components value) {
  for (int k = 0; k < value.count; k++)
    value.of[k] = neighbour_of(g, value.of[k]);
  return tensor_settled(g, value);
}

ir_node lower_family_size(ir *g) {
  ir_node n = ir_unary(g, IR_FAMILY_SUM, ir_constant(g, 1));
  ir_set_name(g, n, "n", (span){0, 0, 0});
  return n;
}

components lower_direction(ir *g, const law *l) {
  static const ends_input chord[] = {ENDS_CLASS_CHORD_X, ENDS_CLASS_CHORD_Y, ENDS_CLASS_CHORD_Z};
  ir_node s = lower_quantity(g, QUANTITY_S);
  components v = {.count = 3};
  for (int k = 0; k < 3; k++)
    v.of[k] =
        k == 2 && is_plane(l) ? ir_constant(g, 0) : ir_div(g, kinematics_input(g, chord[k]), s);
  return v;
}

static ir_node family_sum(ir *g, ir_node n) {
  return ir_unary(g, IR_FAMILY_SUM, n);
}

static components sum_of(ir *g, components v) {
  for (int k = 0; k < v.count; k++)
    v.of[k] = family_sum(g, v.of[k]);
  return tensor_settled(g, v);
}

/* Sums over a divisor, which is 1 where it would be 0: a particle without bonds has mean 0. */
static components over(ir *g, components sums, ir_node divisor) {
  ir_node none = ir_binary(g, IR_EQ, divisor, ir_constant(g, 0));
  ir_node safe = ir_select(g, none, ir_constant(g, 1), divisor);
  for (int k = 0; k < sums.count; k++)
    sums.of[k] = ir_div(g, sums.of[k], safe);
  return tensor_settled(g, sums);
}

static components mean_of(ir *g, components v) {
  const ir_node size = lower_family_size(g);
  return over(g, sum_of(g, v), size);
}

static components weighted_mean(ir *g, components v, ir_node weight) {
  for (int k = 0; k < v.count; k++)
    v.of[k] = ir_mul(g, weight, v.of[k]);
  v = tensor_settled(g, v);
  const ir_node weights = family_sum(g, weight);
  return over(g, sum_of(g, v), weights);
}

static ir_node family_extreme(ir *g, ir_node n, ir_op op) {
  const ir_node zero = ir_constant(g, 0), none = ir_binary(g, IR_EQ, lower_family_size(g), zero);
  return ir_select(g, none, zero, ir_unary(g, op, n));
}

/* --- stress and strain of a family ------------------------------------------------------------ */

/* Products n n^T of the reference direction; what leaves the plane is 0. */
static components dyad(ir *g, const law *l) {
  components n = lower_direction(g, l), v = {.count = TENSOR_COUNT};
  static const int first[] = {0, 1, 2, 0, 1, 0}, second[] = {0, 1, 2, 1, 2, 2};
  for (int k = 0; k < TENSOR_COUNT; k++) {
    bool outside = is_plane(l) && (first[k] == 2 || second[k] == 2);
    v.of[k] = outside ? ir_constant(g, 0) : ir_mul(g, n.of[first[k]], n.of[second[k]]);
  }
  return v;
}

/* --- vectors ---------------------------------------------------------------------------------- */

static components vector_of_components(ir *g, const components *a, int count) {
  components v = {.count = VECTOR_COMPONENT_COUNT};
  for (int k = 0; k < v.count; k++)
    v.of[k] = k < count ? a[k].of[0] : ir_constant(g, 0);
  return v;
}

/* A vector; 0 stands for one of zeros. */
static components wide(components a) {
  for (; a.count < VECTOR_COMPONENT_COUNT; a.count++)
    a.of[a.count] = a.of[0];
  return a;
}

static ir_node vector_dot(ir *g, components a, components b) {
  ir_node sum = ir_constant(g, 0);
  a = wide(a), b = wide(b);
  for (int k = 0; k < VECTOR_COMPONENT_COUNT; k++) {
    const ir_node part = product(g, a.of[k], b.of[k]);
    sum = ir_add(g, sum, part);
  }
  return sum;
}

static components vector_cross(ir *g, components a, components b) {
  components v = {.count = VECTOR_COMPONENT_COUNT};
  a = wide(a), b = wide(b);
  for (int k = 0; k < VECTOR_COMPONENT_COUNT; k++) {
    const int p = (k + 1) % VECTOR_COMPONENT_COUNT, q = (k + 2) % VECTOR_COMPONENT_COUNT;
    const ir_node first = product(g, a.of[p], b.of[q]);
    const ir_node second = product(g, a.of[q], b.of[p]);
    v.of[k] = ir_sub(g, first, second);
  }
  return v;
}

/* (a b + b a)/2 */
static components vector_dyad(ir *g, components a, components b) {
  static const int first[] = {0, 1, 2, 0, 1, 0}, second[] = {0, 1, 2, 1, 2, 2};
  components v = {.count = TENSOR_COUNT};
  a = wide(a), b = wide(b);
  for (int k = 0; k < TENSOR_COUNT; k++) {
    const ir_node one = product(g, a.of[first[k]], b.of[second[k]]);
    const ir_node other = product(g, b.of[first[k]], a.of[second[k]]);
    v.of[k] = one == other ? one : half(g, ir_add(g, one, other));
  }
  return v;
}

/* Which strains a family can resolve: all six, in a plane three. */
static int strain_count(const law *l) {
  return is_plane(l) ? 3 : TENSOR_COUNT;
}
static int strain_part(const law *l, int k) {
  static const int of_plane[] = {TENSOR_XX, TENSOR_YY, TENSOR_XY};
  return is_plane(l) ? of_plane[k] : k;
}

/* Poisson's ratio, which the third direction of a plane needs: the parameter of that name. */
static ir_node poisson(lowering *c, const expr *e) {
  const symbol_list *all = &c->law->parameters;
  for (int k = 0; k < all->count; k++)
    if (strcmp(all->items[k]->name, "nu") == 0) return lower_own_parameter(c, k);
  return lower_fail(c, e->where,
                    "in a plane this needs Poisson's ratio for the third direction: give the law "
                    "a parameter `nu`");
}

bool lower_is_per_volumes(dimension d) {
  const int length = 0; /* of N or of N/m^6: the checker allows nothing else */
  return d.twelfths[length] < 0;
}

ir_node lower_force_of_density(ir *g, const law *l, ir_node density) {
  ir_node V = lower_volume(g, l);
  ir_node both = ir_mul(g, V, neighbour_of(g, V));
  return ir_mul(g, ir_mul(g, ir_constant(g, 2), both), density);
}

static components virtual_work(lowering *c, const expr *e, ir_node force) {
  ir *g = c->graph;
  components n = dyad(g, c->law), v = {.count = TENSOR_COUNT};
  ir_node V = lower_volume(g, c->law);
  if (lower_is_per_volumes(e->arguments[0].value->dim))
    force = lower_force_of_density(g, c->law, force);
  ir_node moment = ir_mul(g, lower_quantity(g, QUANTITY_S), force);
  ir_node twice = ir_mul(g, ir_constant(g, 2), V);
  for (int k = 0; k < TENSOR_COUNT; k++)
    v.of[k] = ir_is_number(g, n.of[k], 0)
                  ? n.of[k]
                  : ir_div(g, family_sum(g, ir_mul(g, moment, n.of[k])), twice);
  if (c->law->setting == SETTING_PLANE_STRAIN) {
    const ir_node in_plane = ir_add(g, v.of[TENSOR_XX], v.of[TENSOR_YY]);
    v.of[TENSOR_ZZ] = ir_mul(g, poisson(c, e), in_plane);
  }
  return v;
}

/* eps = G sum(w n S) with the weight w = 1 on lattices and w = s on irregular families, n = (x^2,
   y^2, x y), in space (x^2, y^2, z^2, x y, y z, x z), and engineering shear. */
static components fit(lowering *c, const expr *e, ir_node stretch) {
  ir *g = c->graph;
  int size = strain_count(c->law);
  components n = dyad(g, c->law), v = {.count = TENSOR_COUNT};
  ir_node sums[TENSOR_COUNT];
  if (c->law->irregular) stretch = ir_mul(g, lower_quantity(g, QUANTITY_S), stretch);
  for (int k = 0; k < size; k++)
    sums[k] = family_sum(g, ir_mul(g, n.of[strain_part(c->law, k)], stretch));
  for (int k = 0; k < TENSOR_COUNT; k++)
    v.of[k] = ir_constant(g, 0);
  for (int row = 0; row < size; row++) {
    ir_node value = ir_constant(g, 0);
    for (int k = 0; k < size; k++)
      value = ir_add(g, value, ir_mul(g, lower_inverse_shape(g, c->law, row, k), sums[k]));
    int part = strain_part(c->law, row);
    v.of[part] = part < TENSOR_XY ? value : ir_mul(g, ir_constant(g, 0.5), value);
  }
  if (c->law->setting == SETTING_PLANE_STRESS) {
    ir_node nu = poisson(c, e);
    ir_node ratio = ir_div(g, nu, ir_sub(g, ir_constant(g, 1), nu));
    v.of[TENSOR_ZZ] = ir_neg(g, ir_mul(g, ratio, ir_add(g, v.of[TENSOR_XX], v.of[TENSOR_YY])));
  }
  return v;
}

/* F = 2 V (w/s) n.(G sigma) with the weights of `fit`: the force state, linear in n n^T, whose
   virtual work is sigma. */
static ir_node uniform_force(ir *g, const law *l, components sigma) {
  int size = strain_count(l);
  components n = dyad(g, l);
  ir_node along = ir_constant(g, 0);
  for (int row = 0; row < size; row++) {
    ir_node value = ir_constant(g, 0);
    for (int k = 0; k < size; k++)
      value = ir_add(g, value,
                     ir_mul(g, lower_inverse_shape(g, l, row, k), sigma.of[strain_part(l, k)]));
    along = ir_add(g, along, ir_mul(g, n.of[strain_part(l, row)], value));
  }
  ir_node force = ir_mul(g, ir_scaled(g, 2, lower_volume(g, l)), along);
  return l->irregular ? force : ir_div(g, force, lower_quantity(g, QUANTITY_S));
}

/* --- calls ------------------------------------------------------------------------------------ */

/* Of a family's vectors as a whole the value is the particle's, and what stands in it is not. */
static components norm(lowering *c, const expr *e, components a) {
  ir *g = c->graph;
  if (a.count > 1) {
    ir_node square = tensor_contract(g, a, a);
    if (e->place == ON_PARTICLE && !ir_is_of_particle(g, square)) square = family_sum(g, square);
    return scalar(ir_unary(g, IR_SQRT, square));
  }
  if (!lower_is_state_law(c)) return scalar(ir_unary(g, IR_ABS, a.of[0])); /* bending in a plane */
  return scalar(ir_unary(g, IR_SQRT, family_sum(g, ir_mul(g, a.of[0], a.of[0]))));
}

static components directed_deviator(ir *g, components a) {
  components mean = mean_of(g, a);
  for (int k = 0; k < a.count; k++)
    a.of[k] = ir_sub(g, a.of[k], mean.of[k]);
  return a;
}

bool lower_is_family_call(const expr *e) {
  builtin_function f = (builtin_function)e->builtin;
  bool extreme = (f == FUNCTION_MIN || f == FUNCTION_MAX) && e->argument_count == 1;
  return f >= FUNCTION_SUM || f == FUNCTION_NORM || extreme;
}

components lower_family_call(lowering *c, const expr *e, const components *a) {
  ir *g = c->graph;
  switch ((builtin_function)e->builtin) {
  case FUNCTION_MIN:
    return scalar(family_extreme(g, a->of[0], IR_FAMILY_MIN));
  case FUNCTION_MAX:
    return scalar(family_extreme(g, a->of[0], IR_FAMILY_MAX));
  case FUNCTION_NORM:
    return norm(c, e, a[0]);
  case FUNCTION_SUM:
    return sum_of(g, a[0]);
  case FUNCTION_MEAN:
    return e->argument_count == 1 ? mean_of(g, a[0]) : weighted_mean(g, a[0], a[1].of[0]);
  case FUNCTION_DEVIATOR:
    return directed_deviator(g, a[0]);
  case FUNCTION_VIRTUAL_WORK:
    return virtual_work(c, e, a->of[0]);
  case FUNCTION_FIT:
    return fit(c, e, a->of[0]);
  case FUNCTION_UNIFORM_FORCE:
    return scalar(uniform_force(g, c->law, a[0]));
  case FUNCTION_UNIFORM_STRETCH:
    return scalar(tensor_contract(g, dyad(g, c->law), a[0]));
  case FUNCTION_HOOKE:
    return tensor_hooke(g, lower_hooke_setting(c), a[0], a[1].of[0], a[2].of[0]);
  case FUNCTION_PRINCIPAL:
    return scalar(tensor_principal(g, a[0], (int)e->arguments[1].value->number));
  case FUNCTION_PRINCIPAL_DIRECTION:
    return tensor_direction(g, a[0], (int)e->arguments[1].value->number);
  case FUNCTION_PRODUCT:
    return tensor_product(g, a[0], a[1]);
  case FUNCTION_TRACE:
    return scalar(tensor_trace(g, a[0]));
  case FUNCTION_DEV:
    return tensor_deviator(g, a[0]);
  case FUNCTION_J2:
    return scalar(tensor_J2(g, a[0]));
  case FUNCTION_VON_MISES:
    return scalar(ir_unary(g, IR_SQRT, ir_scaled(g, 3, tensor_J2(g, a[0]))));
  case FUNCTION_VECTOR:
    return vector_of_components(g, a, e->argument_count);
  case FUNCTION_DOT:
    return scalar(vector_dot(g, a[0], a[1]));
  case FUNCTION_CROSS:
    return vector_cross(g, a[0], a[1]);
  case FUNCTION_DYAD:
    return vector_dyad(g, a[0], a[1]);
  case FUNCTION_TRANSPOSE:
    return general_transpose(a[0]);
  case FUNCTION_SYM:
    return general_symmetric(g, a[0]);
  case FUNCTION_DET:
    return scalar(general_determinant(g, a[0]));
  case FUNCTION_ROTATION:
    return general_rotation(g, a[0]);
  case FUNCTION_INVERSE:
    return general_inverse(g, a[0]);
  case FUNCTION_TENSOR: {
    components v = {.count = e->argument_count > TENSOR_COUNT ? GENERAL_COUNT : TENSOR_COUNT};
    bool zero = v.count == TENSOR_COUNT;
    for (int k = 0; k < v.count; k++) {
      v.of[k] = k < e->argument_count ? a[k].of[0] : ir_constant(g, 0);
      zero &= ir_is_number(g, v.of[k], 0);
    }
    return zero ? tensor_as_deviator(g, v) : v;
  }
  default:
    return lower_failed_value(c, e->where, "this function cannot be compiled here");
  }
}
