/* What goes over a particle's family, and symmetric tensors (see lower_parts.h). Mechanics:
   stress by virtual work, sigma = sum(s F n n^T)/(2 V) (Nikravesh 2017, eq 3.18 with the bond's own
   length), strain from the stretches by least squares over the family. */
#include "generator/lower/lower_parts.h"

#include <math.h>
#include <string.h>

#include "generator/lower/kinematics.h"
#include "runtime/kernel.h"

static ir_node number(lowering *c, double value) {
  return ir_constant(c->graph, value);
}

static bool is_plane(const lowering *c) {
  return c->law->setting != SETTING_SPACE;
}

/* --- families --------------------------------------------------------------------------------- */

static ir_node neighbour_of(lowering *c, ir_node n) {
  const ir *g = c->graph;
  const bool of_body = ir_place(g, n) <= ON_BODY && !ir_is_of_class(g, n);
  return of_body ? n : unary(c->graph, IR_NEIGHBOUR, n);
}

components lower_neighbour(lowering *c, components value) {
  for (int k = 0; k < value.count; k++)
    value.of[k] = neighbour_of(c, value.of[k]);
  return value;
}

ir_node lower_family_size(ir *g) {
  ir_node n = unary(g, IR_FAMILY_SUM, ir_constant(g, 1));
  ir_set_name(g, n, "n", (span){0, 0, 0});
  return n;
}

components lower_direction(lowering *c) {
  static const ends_input chord[] = {ENDS_CLASS_CHORD_X, ENDS_CLASS_CHORD_Y, ENDS_CLASS_CHORD_Z};
  ir_node s = lower_quantity(c->graph, QUANTITY_S);
  components v = {3, {0}};
  for (int k = 0; k < 3; k++)
    v.of[k] = k == 2 && is_plane(c) ? number(c, 0)
                                    : ir_div(c->graph, kinematics_input(c->graph, chord[k]), s);
  return v;
}

static ir_node family_sum(lowering *c, ir_node n) {
  return unary(c->graph, IR_FAMILY_SUM, n);
}

static components sum_of(lowering *c, components v) {
  for (int k = 0; k < v.count; k++)
    v.of[k] = family_sum(c, v.of[k]);
  return v;
}

/* Sums over a divisor, which is 1 where it would be 0: a particle without bonds has mean 0. */
static components over(lowering *c, components sums, ir_node divisor) {
  ir *g = c->graph;
  ir_node none = binary(g, IR_EQ, divisor, number(c, 0));
  ir_node safe = ir_select(g, none, number(c, 1), divisor);
  for (int k = 0; k < sums.count; k++)
    sums.of[k] = ir_div(g, sums.of[k], safe);
  return sums;
}

static components mean_of(lowering *c, components v) {
  return over(c, sum_of(c, v), lower_family_size(c->graph));
}

static components weighted_mean(lowering *c, components v, ir_node weight) {
  for (int k = 0; k < v.count; k++)
    v.of[k] = ir_mul(c->graph, weight, v.of[k]);
  return over(c, sum_of(c, v), family_sum(c, weight));
}

static ir_node family_extreme(lowering *c, ir_node n, ir_op op) {
  ir *g = c->graph;
  ir_node none = binary(g, IR_EQ, lower_family_size(g), number(c, 0));
  return ir_select(g, none, number(c, 0), unary(g, op, n));
}

/* --- tensors ---------------------------------------------------------------------------------- */

static bool is_shear(int k) {
  return k >= TENSOR_XY;
}

static ir_node contract(lowering *c, components a, components b) {
  ir *g = c->graph;
  ir_node sum = number(c, 0);
  for (int k = 0; k < a.count; k++) {
    ir_node term = ir_mul(g, a.of[k], b.of[k]);
    if (a.count == TENSOR_COUNT && is_shear(k)) term = ir_mul(g, number(c, 2), term);
    sum = ir_add(g, sum, term);
  }
  return sum;
}

static ir_node trace(lowering *c, components a) {
  ir_node plane = ir_add(c->graph, a.of[TENSOR_XX], a.of[TENSOR_YY]);
  return ir_add(c->graph, plane, a.of[TENSOR_ZZ]);
}

static components deviator(lowering *c, components a) {
  ir_node third = ir_div(c->graph, trace(c, a), number(c, 3));
  for (int k = 0; k < TENSOR_XY; k++)
    a.of[k] = ir_sub(c->graph, a.of[k], third);
  return a;
}

static ir_node half(lowering *c, ir_node n) {
  return ir_mul(c->graph, number(c, 0.5), n);
}

static ir_node root(lowering *c, ir_node n) {
  return unary(c->graph, IR_SQRT, n);
}

static ir_node J2(lowering *c, components a) {
  components s = deviator(c, a);
  return half(c, contract(c, s, s));
}

static bool is_zero(lowering *c, ir_node n) {
  return ir_operation(c->graph, n) == IR_CONSTANT && ir_value(c->graph, n) == 0;
}

/* The pair in the plane, and the third direction among them. */
static ir_node plane_principal(lowering *c, components a, int which) {
  ir *g = c->graph;
  ir_node middle = half(c, ir_add(g, a.of[TENSOR_XX], a.of[TENSOR_YY]));
  ir_node difference = half(c, ir_sub(g, a.of[TENSOR_XX], a.of[TENSOR_YY]));
  ir_node square = ir_mul(g, difference, difference);
  ir_node radius = root(c, ir_add(g, square, ir_mul(g, a.of[TENSOR_XY], a.of[TENSOR_XY])));
  ir_node large = ir_add(g, middle, radius), small = ir_sub(g, middle, radius);
  ir_node third = a.of[TENSOR_ZZ];
  if (which == 1) return binary(g, IR_MAX, large, third);
  if (which == 3) return binary(g, IR_MIN, small, third);
  return binary(g, IR_MAX, small, binary(g, IR_MIN, large, third));
}

static ir_node determinant(lowering *c, components a) {
  ir *g = c->graph;
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
static ir_node space_principal(lowering *c, components a, int which) {
  ir *g = c->graph;
  ir_node mean = ir_div(g, trace(c, a), number(c, 3));
  components s = deviator(c, a);
  ir_node size = root(c, ir_div(g, contract(c, s, s), number(c, 6)));
  ir_node cube = ir_mul(g, ir_mul(g, size, size), size);
  ir_node safe = binary(g, IR_MAX, ir_mul(g, number(c, 2), cube), number(c, 1e-290));
  ir_node ratio = ir_div(g, determinant(c, s), safe);
  ir_node cosine = binary(g, IR_MAX, binary(g, IR_MIN, ratio, number(c, 1)), number(c, -1));
  ir_node sine =
      root(c, binary(g, IR_MAX, ir_sub(g, number(c, 1), ir_mul(g, cosine, cosine)), number(c, 0)));
  ir_node angle = ir_div(g, binary(g, IR_ATAN2, sine, cosine), number(c, 3));
  ir_node twice = ir_mul(g, number(c, 2), size);
  ir_node first = ir_add(g, mean, ir_mul(g, twice, unary(g, IR_COS, angle)));
  ir_node turned = ir_add(g, angle, number(c, 2.0943951023931954923)); /* 2 pi/3 */
  ir_node last = ir_add(g, mean, ir_mul(g, twice, unary(g, IR_COS, turned)));
  if (which == 1) return first;
  if (which == 3) return last;
  return ir_sub(g, ir_sub(g, ir_mul(g, number(c, 3), mean), first), last);
}

static ir_node principal(lowering *c, components a, int which) {
  bool plane = is_zero(c, a.of[TENSOR_YZ]) && is_zero(c, a.of[TENSOR_XZ]);
  return plane ? plane_principal(c, a, which) : space_principal(c, a, which);
}

components lower_tensor_binary(lowering *c, const expr *e, components a, components b) {
  ir *g = c->graph;
  if (e->binary == OP_CONTRACT && a.count == b.count) return scalar(contract(c, a, b));
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
      v.of[k] = ir_mul(g, left, right);
      break;
    default:
      v.of[k] = ir_div(g, left, right);
    }
  }
  return v;
}

/* --- stress and strain of a family ------------------------------------------------------------ */

/* Products n n^T of the reference direction; what leaves the plane is 0. */
static components dyad(lowering *c) {
  ir *g = c->graph;
  components n = lower_direction(c), v = {TENSOR_COUNT, {0}};
  static const int first[] = {0, 1, 2, 0, 1, 0}, second[] = {0, 1, 2, 1, 2, 2};
  for (int k = 0; k < TENSOR_COUNT; k++) {
    bool outside = is_plane(c) && (first[k] == 2 || second[k] == 2);
    v.of[k] = outside ? number(c, 0) : ir_mul(g, n.of[first[k]], n.of[second[k]]);
  }
  return v;
}

/* Poisson's ratio, which the third direction of a plane needs: the parameter of that name. */
static ir_node poisson(lowering *c, const expr *e) {
  const symbol_list *all = &c->law->parameters;
  for (int k = 0; k < all->count; k++)
    if (strcmp(all->items[k]->name, "nu") == 0) return lower_parameter(c->graph, c->law, k);
  return lower_fail(c, e->where,
                    "in a plane this needs Poisson's ratio for the third direction: give the law "
                    "a parameter `nu`");
}

bool lower_is_per_volumes(dimension d) {
  const int length = 0; /* of N or of N/m^6: the checker allows nothing else */
  return d.twelfths[length] < 0;
}

ir_node lower_force_of_density(lowering *c, ir_node density) {
  ir_node V = lower_volume(c);
  ir_node both = ir_mul(c->graph, V, neighbour_of(c, V));
  return ir_mul(c->graph, ir_mul(c->graph, number(c, 2), both), density);
}

static components virtual_work(lowering *c, const expr *e, ir_node force) {
  ir *g = c->graph;
  components n = dyad(c), v = {TENSOR_COUNT, {0}};
  ir_node V = lower_volume(c);
  if (lower_is_per_volumes(e->arguments[0].value->dim)) force = lower_force_of_density(c, force);
  ir_node moment = ir_mul(g, lower_quantity(g, QUANTITY_S), force);
  ir_node twice = ir_mul(g, number(c, 2), V);
  for (int k = 0; k < TENSOR_COUNT; k++)
    v.of[k] =
        is_zero(c, n.of[k]) ? n.of[k] : ir_div(g, family_sum(c, ir_mul(g, moment, n.of[k])), twice);
  if (c->law->setting == SETTING_PLANE_STRAIN)
    v.of[TENSOR_ZZ] = ir_mul(g, poisson(c, e), ir_add(g, v.of[TENSOR_XX], v.of[TENSOR_YY]));
  return v;
}

/* Entry (row, column) of the inverse shape matrix, which the runtime keeps for each particle as an
   upper triangle. */
static ir_node inverse_shape(lowering *c, int row, int column) {
  static const char *const names[] = {
      "shape_0",  "shape_1",  "shape_2",  "shape_3",  "shape_4",  "shape_5",  "shape_6",
      "shape_7",  "shape_8",  "shape_9",  "shape_10", "shape_11", "shape_12", "shape_13",
      "shape_14", "shape_15", "shape_16", "shape_17", "shape_18", "shape_19", "shape_20"};
  int size = is_plane(c) ? 3 : 6;
  int r = row < column ? row : column, q = row < column ? column : row;
  int at = r * size - r * (r - 1) / 2 + (q - r);
  return ir_input(c->graph, IR_FROM_SHAPE, at, names[at], ON_PARTICLE);
}

ir_node lower_resolved(lowering *c) {
  return ir_input(c->graph, IR_FROM_SHAPE, PL_SHAPE_VALUES(is_plane(c) ? 2 : 3), "resolved",
                  ON_PARTICLE);
}

/* eps = G sum(w n S) with the weight w = 1 on lattices and w = s on irregular families, n = (x^2, y^2, x y), in space
   (x^2, y^2, z^2, x y, y z, x z), and engineering shear. */
static components fit(lowering *c, const expr *e, ir_node stretch) {
  ir *g = c->graph;
  static const int plane_parts[] = {TENSOR_XX, TENSOR_YY, TENSOR_XY};
  int size = is_plane(c) ? 3 : TENSOR_COUNT;
  components n = dyad(c), v = {TENSOR_COUNT, {0}};
  ir_node sums[TENSOR_COUNT];
  if (c->law->irregular) stretch = ir_mul(g, lower_quantity(g, QUANTITY_S), stretch);
  for (int k = 0; k < size; k++)
    sums[k] = family_sum(c, ir_mul(g, n.of[is_plane(c) ? plane_parts[k] : k], stretch));
  for (int k = 0; k < TENSOR_COUNT; k++)
    v.of[k] = number(c, 0);
  for (int row = 0; row < size; row++) {
    ir_node value = number(c, 0);
    for (int k = 0; k < size; k++)
      value = ir_add(g, value, ir_mul(g, inverse_shape(c, row, k), sums[k]));
    int part = is_plane(c) ? plane_parts[row] : row;
    v.of[part] = is_shear(part) ? half(c, value) : value;
  }
  if (c->law->setting == SETTING_PLANE_STRESS) {
    ir_node nu = poisson(c, e);
    ir_node ratio = ir_div(g, nu, ir_sub(g, number(c, 1), nu));
    v.of[TENSOR_ZZ] = ir_neg(g, ir_mul(g, ratio, ir_add(g, v.of[TENSOR_XX], v.of[TENSOR_YY])));
  }
  return v;
}

/* F = 2 V (w/s) n.(G sigma) with the weights of `fit`: the force state, linear in n n^T, whose virtual work is sigma. */
static ir_node uniform_force(lowering *c, components sigma) {
  ir *g = c->graph;
  static const int plane_parts[] = {TENSOR_XX, TENSOR_YY, TENSOR_XY};
  int size = is_plane(c) ? 3 : TENSOR_COUNT;
  components n = dyad(c);
  ir_node along = number(c, 0);
  for (int row = 0; row < size; row++) {
    ir_node value = number(c, 0);
    for (int k = 0; k < size; k++)
      value =
          ir_add(g, value,
                 ir_mul(g, inverse_shape(c, row, k), sigma.of[is_plane(c) ? plane_parts[k] : k]));
    along = ir_add(g, along, ir_mul(g, n.of[is_plane(c) ? plane_parts[row] : row], value));
  }
  ir_node force = ir_mul(g, ir_mul(g, number(c, 2), lower_volume(c)), along);
  return c->law->irregular ? force : ir_div(g, force, lower_quantity(g, QUANTITY_S));
}

/* Isotropic elasticity. In plane stress the third direction is free: sigma_zz = 0 whatever eps_zz says. */
static components hooke(lowering *c, components eps, ir_node E, ir_node nu) {
  ir *g = c->graph;
  ir_node one = number(c, 1), two = number(c, 2);
  ir_node twice_mu = ir_div(g, E, ir_add(g, one, nu)), lambda, sum;
  if (c->law->setting == SETTING_PLANE_STRESS) {
    lambda = ir_div(g, ir_mul(g, E, nu), ir_sub(g, one, ir_mul(g, nu, nu)));
    sum = ir_add(g, eps.of[TENSOR_XX], eps.of[TENSOR_YY]);
  } else {
    ir_node below = ir_mul(g, ir_add(g, one, nu), ir_sub(g, one, ir_mul(g, two, nu)));
    lambda = ir_div(g, ir_mul(g, E, nu), below);
    sum = trace(c, eps);
  }
  ir_node pressure = ir_mul(g, lambda, sum);
  for (int k = 0; k < TENSOR_COUNT; k++) {
    eps.of[k] = ir_mul(g, twice_mu, eps.of[k]);
    if (k < TENSOR_XY) eps.of[k] = ir_add(g, pressure, eps.of[k]);
  }
  if (c->law->setting == SETTING_PLANE_STRESS) eps.of[TENSOR_ZZ] = number(c, 0);
  return eps;
}

/* --- calls ------------------------------------------------------------------------------------ */

static components norm(lowering *c, components a) {
  ir *g = c->graph;
  if (a.count > 1) return scalar(root(c, contract(c, a, a)));
  if (!lower_is_state_law(c)) return scalar(unary(g, IR_ABS, a.of[0])); /* bending in a plane */
  return scalar(root(c, family_sum(c, ir_mul(g, a.of[0], a.of[0]))));
}

static components directed_deviator(lowering *c, components a) {
  components mean = mean_of(c, a);
  for (int k = 0; k < a.count; k++)
    a.of[k] = ir_sub(c->graph, a.of[k], mean.of[k]);
  return a;
}

static components lower_mean(lowering *c, const expr *e) {
  components v = lower_value(c, e->arguments[0].value);
  if (e->argument_count == 1) return mean_of(c, v);
  return weighted_mean(c, v, lower_expr(c, e->arguments[1].value));
}

bool lower_family_call(lowering *c, const expr *e, components *out) {
  builtin_function f = (builtin_function)e->builtin;
  bool extreme = (f == FUNCTION_MIN || f == FUNCTION_MAX) && e->argument_count == 1;
  if (f < FUNCTION_SUM && f != FUNCTION_NORM && !extreme) return false;
  if (f == FUNCTION_MEAN) {
    *out = lower_mean(c, e);
    return true;
  }
  components a = lower_value(c, e->arguments[0].value);
  if (c->failed) {
    *out = a;
    return true;
  }
  switch (f) {
  case FUNCTION_MIN:
  case FUNCTION_MAX:
    *out = scalar(family_extreme(c, a.of[0], f == FUNCTION_MIN ? IR_FAMILY_MIN : IR_FAMILY_MAX));
    break;
  case FUNCTION_NORM:
    *out = norm(c, a);
    break;
  case FUNCTION_SUM:
    *out = sum_of(c, a);
    break;
  case FUNCTION_DEVIATOR:
    *out = directed_deviator(c, a);
    break;
  case FUNCTION_VIRTUAL_WORK:
    *out = virtual_work(c, e, a.of[0]);
    break;
  case FUNCTION_FIT:
    *out = fit(c, e, a.of[0]);
    break;
  case FUNCTION_UNIFORM_FORCE:
    *out = scalar(uniform_force(c, a));
    break;
  case FUNCTION_UNIFORM_STRETCH:
    *out = scalar(contract(c, dyad(c), a));
    break;
  case FUNCTION_HOOKE: {
    ir_node E = lower_expr(c, e->arguments[1].value);
    *out = hooke(c, a, E, lower_expr(c, e->arguments[2].value));
    break;
  }
  case FUNCTION_PRINCIPAL:
    *out = scalar(principal(c, a, (int)e->arguments[1].value->number));
    break;
  case FUNCTION_TRACE:
    *out = scalar(trace(c, a));
    break;
  case FUNCTION_DEV:
    *out = deviator(c, a);
    break;
  case FUNCTION_J2:
    *out = scalar(J2(c, a));
    break;
  case FUNCTION_VON_MISES:
    *out = scalar(root(c, ir_mul(c->graph, number(c, 3), J2(c, a))));
    break;
  default:
    return false;
  }
  return true;
}

/* --- energy ----------------------------------------------------------------------------------- */

/* By the stretch of the bond to j; its length is s (1 + stretch). */
static ir_node by_stretch(lowering *c, ir_node n) {
  ir *g = c->graph;
  ir_node slope = ir_derivative(g, n, lower_quantity(g, QUANTITY_STRETCH));
  ir_node by_length = ir_derivative(g, n, lower_quantity(g, QUANTITY_LENGTH));
  if (is_zero(c, by_length)) return slope;
  return ir_add(g, slope, ir_mul(g, lower_quantity(g, QUANTITY_S), by_length));
}

/* Sums over the family that W is made of, each as if it were an independent variable: dW/dstretch
   toward j is the sum over them of dW/dsum times the derivative of what stands in it at j. A bond
   belongs to two particles, so that the force state is twice what W alone gives. */
ir_node lower_force_state_of_energy(lowering *c, ir_node W) {
  ir *g = c->graph;
  ir_node slope = number(c, 0);
  unsigned char *marks = arena_alloc(c->memory, (size_t)ir_count(g) + 1);
  int count = ir_count(g);
  memset(marks, 0, (size_t)count + 1);
  ir_mark(g, &W, 1, marks);
  for (ir_node n = 0; n < count; n++) {
    ir_op op = ir_operation(g, n);
    if (!marks[n] ||
        (op != IR_FAMILY_SUM && op != IR_FAMILY_MAX && op != IR_FAMILY_MIN && op != IR_NEIGHBOUR))
      continue;
    ir_node inside = ir_operand(g, n, 0), by = by_stretch(c, inside);
    if (is_zero(c, by)) continue;
    if (op != IR_FAMILY_SUM)
      return lower_fail(c, c->law->tree->name_where,
                        "a force state can be derived from an energy that is made of sums over "
                        "the family only");
    unsigned char *below = arena_alloc(c->memory, (size_t)count + 1);
    memset(below, 0, (size_t)count + 1);
    ir_mark(g, &inside, 1, below);
    for (ir_node k = 0; k < n; k++)
      if (below[k] && ir_operation(g, k) == IR_FAMILY_SUM &&
          !is_zero(c, by_stretch(c, ir_operand(g, k, 0))))
        return lower_fail(c, c->law->tree->name_where,
                          "a force state cannot be derived from sums inside sums over the family");
    slope = ir_add(g, slope, ir_mul(g, ir_derivative(g, W, n), by));
  }
  ir_node per_length = ir_div(g, number(c, 2), lower_quantity(g, QUANTITY_S));
  return ir_mul(g, per_length, slope);
}
