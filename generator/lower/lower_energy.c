#include "generator/lower/lower_energy.h"

#include <string.h>

#include "generator/ir/derive.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/kinematics.h"
#include "generator/lower/lower_inputs.h"

/* --- of a bond -------------------------------------------------------------------------------- */

/* N with the stretch, M_i with theta_i, M_j with theta_j, T with the twist. */
enum { ENERGY_PAIRS = 2 + 2 * BENDING_AXES };

typedef struct energy_parts {
  ir_node force[ENERGY_PAIRS];  /* [count] at zero rate */
  ir_node motion[ENERGY_PAIRS]; /* [count] */
  int count;
  ir_node s, length;
} energy_parts;

static void add_part(energy_parts *p, ir_node force, ir_node motion) {
  p->force[p->count] = force;
  p->motion[p->count++] = motion;
}

static energy_parts parts_at_zero_rate(ir *g, const law *l, const lowered_law *frozen) {
  static const builtin_quantity theta[] = {QUANTITY_THETA_I, QUANTITY_THETA_J};
  const ir_node *moments[] = {frozen->M_i, frozen->M_j};
  energy_parts p = {.s = IR_NONE};
  add_part(&p, frozen->N, lower_quantity(g, QUANTITY_STRETCH));
  p.s = lower_quantity(g, QUANTITY_S);
  p.length = lower_quantity(g, QUANTITY_LENGTH);
  ir_node rate = lower_quantity(g, QUANTITY_STRETCH_RATE);
  for (int end = 0; end < 2; end++)
    for (int k = 0; k < BENDING_AXES && moments[end][k] != IR_NONE; k++)
      add_part(&p, moments[end][k], lower_bending(g, l, theta[end], k));
  if (frozen->T != IR_NONE) add_part(&p, frozen->T, lower_quantity(g, QUANTITY_TWIST));
  for (int k = 0; k < p.count; k++)
    rewrite_zero(g, &p.force[k], 1, &rate, 1, &p.force[k]);
  return p;
}

static bool is_homogeneous(const ir *g, ir_node f, const energy_parts *p) {
  if (rewrite_depends(g, &f, 1, &p->length, 1)) /* s (1 + stretch) is not */
    return false;
  double degree = rewrite_degree(g, f, p->motion, p->count);
  return degree == 1 || degree == REWRITE_ZERO;
}

/* Work of force k over its motion; that of N is N s d(stretch). */
static ir_node work(ir *g, const energy_parts *p, int k, ir_node force) {
  ir_node w = ir_mul(g, force, p->motion[k]);
  return k == 0 ? ir_mul(g, w, p->s) : w;
}

static ir_node add_some(ir *g, ir_node a, ir_node b) {
  return a == IR_NONE ? b : ir_add(g, a, b);
}

static ir_node half_work(ir *g, const energy_parts *p, int first) {
  ir_node sum = IR_NONE;
  for (int k = first; k < p->count; k++)
    sum = add_some(g, sum, half(g, work(g, p, k, p->force[k])));
  return sum;
}

/* N = k (stretch - stretch_0): s N^2/(2k), zero where it is stress-free. With k = 0 the bond
   carries nothing. IR_NONE when N is not of this form. */
static ir_node affine_energy(ir *g, const energy_parts *p) {
  ir_node N = p->force[0];
  ir_node moving[ENERGY_PAIRS + 1];
  memcpy(moving, p->motion, (size_t)p->count * sizeof *moving);
  moving[p->count] = p->length;
  ir_node k = ir_derivative(g, N, p->motion[0]);
  if (rewrite_depends(g, &N, 1, moving + 1, p->count) ||
      rewrite_depends(g, &k, 1, moving, p->count + 1) || ir_operation(g, k) == IR_CONSTANT)
    return IR_NONE;
  ir_node one = ir_constant(g, 1);
  ir_node none = ir_binary(g, IR_EQ, k, ir_constant(g, 0));
  ir_node divisor = ir_select(g, none, one, k);
  return half(g, ir_div(g, ir_mul(g, ir_mul(g, N, N), p->s), divisor));
}

/* Integral over the straight path from rest: Gauss-Legendre on [0, 1]. */
static ir_node path_energy(ir *g, const energy_parts *p) {
  static const double at[2] = {0.86113631159405257522, 0.33998104358485626480};
  static const double weight[2] = {0.34785484513745385737, 0.65214515486254614263};
  ir_node sum = IR_NONE;
  for (int point = 0; point < 4; point++) {
    double sign = point < 2 ? -1 : 1;
    ir_node fraction = ir_constant(g, 0.5 * (1 + sign * at[point % 2]));
    ir_node from[ENERGY_PAIRS + 1], to[ENERGY_PAIRS + 1];
    int count = 0;
    for (int k = 0; k < p->count; k++) {
      from[count] = p->motion[k];
      to[count++] = ir_mul(g, fraction, p->motion[k]);
    }
    from[count] = p->length;
    to[count++] = ir_add(g, p->s, ir_mul(g, fraction, ir_sub(g, p->length, p->s)));
    for (int k = 0; k < p->count; k++) {
      ir_node here;
      ir_substitute(g, &p->force[k], 1, from, to, count, &here);
      sum = add_some(g, sum, ir_scaled(g, 0.5 * weight[point % 2], work(g, p, k, here)));
    }
  }
  return sum;
}

ir_node lower_stored_energy(ir *g, const law *l, const lowered_law *frozen) {
  if (frozen->W != IR_NONE) {
    ir_node rate = lower_quantity(g, QUANTITY_STRETCH_RATE), W;
    rewrite_zero(g, &frozen->W, 1, &rate, 1, &W);
    return W;
  }
  energy_parts p = parts_at_zero_rate(g, l, frozen);
  const bool central = p.count == 1, axial_is = is_homogeneous(g, p.force[0], &p);
  bool moments_are = true;
  for (int k = 1; k < p.count; k++)
    moments_are = is_homogeneous(g, p.force[k], &p) && moments_are;
  if (axial_is && moments_are) return half_work(g, &p, 0);
  const bool apart = central || !rewrite_depends(g, p.force + 1, p.count - 1, p.motion, 1);
  ir_node axial = apart && moments_are ? affine_energy(g, &p) : IR_NONE;
  if (axial == IR_NONE) return path_energy(g, &p);
  return central ? axial : ir_add(g, axial, half_work(g, &p, 1));
}

ir_node lower_rate_power(ir *g, const law *l, const lowered_law *frozen, ir_node theta_rate_i,
                         ir_node theta_rate_j, ir_node twist_rate) {
  energy_parts p = parts_at_zero_rate(g, l, frozen);
  ir_node whole[] = {frozen->N, frozen->M_i[0], frozen->M_j[0], frozen->T};
  ir_node length_rate = ir_mul(g, lower_quantity(g, QUANTITY_STRETCH_RATE), p.s);
  ir_node rate[] = {length_rate, theta_rate_i, theta_rate_j, twist_rate};
  ir_node power = IR_NONE, stretch_rate = lower_quantity(g, QUANTITY_STRETCH_RATE);
  for (int k = 0; k < p.count; k++) {
    if (!rewrite_depends(g, &whole[k], 1, &stretch_rate, 1)) continue;
    ir_node part = ir_sub(g, whole[k], p.force[k]);
    power = add_some(g, power, ir_mul(g, part, rate[k]));
  }
  return power;
}

ir_node lower_still_power(ir *g, const law *l, const lowered_law *frozen, ir_node theta_rate_i,
                          ir_node theta_rate_j, ir_node twist_rate) {
  const energy_parts p = parts_at_zero_rate(g, l, frozen);
  const ir_node length_rate = ir_mul(g, lower_quantity(g, QUANTITY_STRETCH_RATE), p.s),
                rate[] = {length_rate, theta_rate_i, theta_rate_j, twist_rate};
  ir_node power = IR_NONE;
  for (int k = 0; k < p.count; k++)
    power = add_some(g, power, ir_mul(g, p.force[k], rate[k]));
  return power;
}

/* --- of a family ------------------------------------------------------------------------------ */

/* By the stretch of the bond to j; its length is s (1 + stretch). */
static ir_node by_stretch(ir *g, ir_node n) {
  ir_node slope = ir_derivative(g, n, lower_quantity(g, QUANTITY_STRETCH));
  ir_node by_length = ir_derivative(g, n, lower_quantity(g, QUANTITY_LENGTH));
  if (ir_is_number(g, by_length, 0)) return slope;
  return ir_add(g, slope, ir_mul(g, lower_quantity(g, QUANTITY_S), by_length));
}

/* Stands for the k-th sum over the family while it is held. */
static ir_node held_sum(const lowering *c, int k) {
  return ir_input(c->graph, IR_FROM_FIELD, 2 * c->law->fields.count + 1 + k, "sum", ON_PARTICLE);
}

/* The sums that W is made of, inner ones first. */
typedef struct sums {
  ir_node *sum; /* [count] */
  int count;
} sums;

/* False after a message where W is made of the bonds' motion in another way. */
static bool find_sums(lowering *c, ir_node W, ir_node (*by)(ir *g, ir_node n), sums *found) {
  ir *g = c->graph;
  const int nodes = ir_count(g);
  unsigned char *marks = arena_alloc(c->memory, (size_t)nodes + 1);
  *found = (sums){arena_alloc(c->memory, ((size_t)nodes + 1) * sizeof(ir_node)), 0};
  memset(marks, 0, (size_t)nodes + 1);
  ir_mark(g, &W, 1, marks);
  for (ir_node n = 0; n < nodes; n++) {
    const ir_op op = ir_operation(g, n);
    if (!marks[n]) continue;
    if (op == IR_FAMILY_SUM) {
      found->sum[found->count++] = n;
    } else if ((op == IR_FAMILY_MAX || op == IR_FAMILY_MIN || op == IR_NEIGHBOUR) &&
               !ir_is_number(g, by(g, ir_operand(g, n, 0)), 0)) {
      lower_fail(c, c->law->tree->name_where,
                 "a force state can be derived from an energy that is made of sums over the "
                 "family only");
      return false;
    }
  }
  return true;
}

/* The derivative of what stands in sum k by what the bond to j has, while inner sums are held. */
static ir_node slope_inside(lowering *c, const sums *s, int k, ir_node (*by)(ir *g, ir_node n)) {
  ir *g = c->graph;
  ir_node inside = ir_operand(g, s->sum[k], 0);
  if (!rewrite_depends(g, &inside, 1, s->sum, k)) return by(g, inside);
  ir_node *held = arena_alloc(c->memory, (size_t)k * sizeof *held);
  for (int n = 0; n < k; n++)
    held[n] = held_sum(c, n);
  ir_substitute(g, &inside, 1, s->sum, held, k, &inside);
  ir_node part = by(g, inside);
  ir_substitute(g, &part, 1, held, s->sum, k, &part);
  return part;
}

/* The derivative of W by what the bond to j alone has: of the sums that it is made of, through
   other sums, too, times that of what stands in them at j while all sums are held. */
static ir_node slope_at_neighbour(lowering *c, ir_node W, ir_node (*by)(ir *g, ir_node n)) {
  ir *g = c->graph;
  ir_node slope = ir_constant(g, 0);
  sums s;
  if (!find_sums(c, W, by, &s)) return slope;
  for (int k = 0; k < s.count; k++) {
    const ir_node part = slope_inside(c, &s, k, by);
    if (ir_is_number(g, part, 0)) continue;
    const ir_node outer = ir_derivative(g, W, s.sum[k]);
    slope = ir_add(g, slope, ir_mul(g, outer, part));
  }
  return slope;
}

/* A bond belongs to two particles, so that the force state is twice what W alone gives. */
ir_node lower_force_state_of_energy(lowering *c, ir_node W) {
  ir *g = c->graph;
  const ir_node slope = slope_at_neighbour(c, W, by_stretch);
  const ir_node s = lower_quantity(g, QUANTITY_S), per_length = ir_div(g, ir_constant(g, 2), s);
  return ir_mul(g, per_length, slope);
}

/* --- of a family whose particles move each in its own way ------------------------------------- */

static const ends_input own[] = {ENDS_U_IX, ENDS_U_IY, ENDS_U_IZ},
                        far[] = {ENDS_U_JX, ENDS_U_JY, ENDS_U_JZ},
                        chord[] = {ENDS_CLASS_CHORD_X, ENDS_CLASS_CHORD_Y, ENDS_CLASS_CHORD_Z};

static ir_node by_far_x(ir *g, ir_node n) {
  return ir_derivative(g, n, kinematics_input(g, ENDS_U_JX));
}
static ir_node by_far_y(ir *g, ir_node n) {
  return ir_derivative(g, n, kinematics_input(g, ENDS_U_JY));
}
static ir_node by_far_z(ir *g, ir_node n) {
  return ir_derivative(g, n, kinematics_input(g, ENDS_U_JZ));
}

/* What stretches make of it acts along the present bond. */
void lower_force_vector_of_energy(lowering *c, ir_node W, ir_node F[FORCE_AXES]) {
  static ir_node (*const by[FORCE_AXES])(ir * g, ir_node n) = {by_far_x, by_far_y, by_far_z};
  ir *g = c->graph;
  ir_node from[FORCE_AXES], to[FORCE_AXES];
  for (int d = 0; d < FORCE_AXES; d++) {
    from[d] = ir_unary(g, IR_NEIGHBOUR, kinematics_input(g, own[d]));
    to[d] = kinematics_input(g, far[d]);
  }
  ir_substitute(g, &W, 1, from, to, FORCE_AXES, &W);
  const ir_node along = lower_force_state_of_energy(c, W);
  const ir_node per_length = ir_div(g, along, lower_quantity(g, QUANTITY_LENGTH));
  for (int d = 0; d < lower_dimensions(c->law) && !c->failed; d++) {
    F[d] = ir_scaled(g, 2, slope_at_neighbour(c, W, by[d]));
    if (ir_is_number(g, along, 0)) continue;
    const ir_node moved = ir_sub(g, to[d], kinematics_input(g, own[d]));
    const ir_node now = ir_add(g, kinematics_input(g, chord[d]), moved);
    F[d] = ir_add(g, F[d], ir_mul(g, per_length, now));
  }
}
