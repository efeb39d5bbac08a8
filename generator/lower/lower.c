#include "generator/lower/lower.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/semantics/law_reads.h"
#include "generator/ir/derive.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/kinematics.h"
#include "generator/lower/lower_energy.h"
#include "generator/lower/lower_family.h"
#include "generator/lower/lower_inputs.h"
#include "generator/lower/lower_rate.h"
#include "generator/lower/lower_slip.h"
#include "generator/lower/lower_solved.h"
#include "generator/lower/lower_tensor.h"
#include "generator/lower/lower_value.h"
#include "generator/lower/point_inputs.h"

/* --- rules ------------------------------------------------------------------------------------ */

/* Where a damage stays as it is; IR_NONE where nothing is held. In families a bond is held with
   either of its particles. */
static ir_node held_where(lowering *c, placement on) {
  ir *g = c->graph;
  ir_node zero = ir_constant(g, 0);
  if (c->mode == LOWER_PROTECTABLE)
    return ir_binary(g, IR_LT, zero, kinematics_input(g, ENDS_PROTECTED));
  if (c->mode != LOWER_HELD) return IR_NONE;
  ir_node mine = ir_binary(g, IR_LT, zero, kinematics_input(g, ENDS_HELD_I));
  if (on == ON_PARTICLE) return mine;
  return ir_binary(g, IR_OR, mine, ir_binary(g, IR_LT, zero, kinematics_input(g, ENDS_HELD_J)));
}

/* min(max(old, rule), 1) in a form in which a rule that is not a number stays so, and is found. */
static ir_node clamp_damage(lowering *c, placement on, ir_node old, ir_node rule) {
  ir *g = c->graph;
  ir_node one = ir_constant(g, 1);
  ir_node grown = ir_select(g, ir_binary(g, IR_LT, rule, old), old, rule);
  ir_node clamped = ir_select(g, ir_binary(g, IR_LT, one, grown), one, grown);
  ir_node held = held_where(c, on);
  return held == IR_NONE ? clamped : ir_select(g, held, old, clamped);
}

/* a - b of a guard a >= b or a > b. */
static ir_node overstress_of(lowering *c, const expr *when) {
  if (!when || when->kind != EXPR_BINARY) return IR_NONE;
  binary_op op = when->binary;
  if (op != OP_GE && op != OP_GT && op != OP_LE && op != OP_LT) return IR_NONE;
  ir_node a = lower_expr(c, when->left), b = lower_expr(c, when->right);
  return op == OP_GE || op == OP_GT ? ir_sub(c->graph, a, b) : ir_sub(c->graph, b, a);
}

static void note_flow(lowering *c, const stmt *rule, ir_node when) {
  if (c->mode == LOWER_STEP) lower_note_flow(c, rule, when, overstress_of(c, rule->when));
}

/* old + lambda direction */
static components along(ir *g, components old, ir_node lambda, components direction) {
  for (int k = 0; k < old.count; k++)
    old.of[k] = ir_add(g, old.of[k], ir_mul(g, lambda, direction.of[k]));
  return tensor_settled(g, old);
}

static components chosen(ir *g, ir_node when, components a, components b) {
  for (int k = 0; k < a.count; k++)
    a.of[k] = ir_select(g, when, a.of[k], b.of[k]);
  return tensor_settled(g, a);
}

/* What stands for previous values of flows that are solved for, and these. */
static int kept_fields(lowering *c, ir_node *from, ir_node *to) {
  const symbol_list *fields = &c->law->fields;
  int count = 0;
  for (int k = 0; k < fields->count; k++) {
    const symbol *s = fields->items[k];
    if (!lower_is_solved(s->component_of ? s->component_of : s)) continue;
    from[count] = lower_kept_field(c->graph, c->law, k);
    to[count++] = lower_field(c->graph, c->law, k);
  }
  return count;
}

/* f as it is before x flows: lambda is 0 (NULL: it is not there), x its previous value, and x less
   that nothing. */
static ir_node before_flow(lowering *c, ir_node f, const ir_node *lambda) {
  const size_t fields = (size_t)c->law->fields.count + 1;
  ir_node *from = must_alloc(fields * sizeof *from), *to = must_alloc(fields * sizeof *to);
  const int pairs = kept_fields(c, from, to);
  ir_substitute(c->graph, &f, 1, from, to, pairs, &f);
  rewrite_zero(c->graph, &f, 1, lambda, lambda ? 1 : 0, &f);
  free(from);
  free(to);
  return f;
}

/* Whether f is 0, to rounding. */
static ir_node has_returned(ir *g, ir_node over) {
  static const double RETURNED = 1e-9; /* of what is added up to f */
  const ir_node most = ir_scaled(g, RETURNED, rewrite_size(g, over));
  return ir_binary(g, IR_LE, ir_unary(g, IR_ABS, over), most);
}

/* lambda with f = 0, where f is linear in it: f(0) by its slope, which is uniform in most laws. */
static ir_node found_at_once(lowering *c, ir_node over, ir_node slope, ir_node lambda) {
  ir *g = c->graph;
  const ir_node start = before_flow(c, over, &lambda), minus = ir_constant(g, -1);
  const ir_node falls = ir_binary(g, IR_LT, slope, ir_constant(g, 0));
  const ir_node pace = ir_div(g, minus, ir_select(g, falls, slope, minus));
  return ir_mul(g, start, ir_add(g, pace, lower_zero_if(g, falls)));
}

/* Of the flow noted last: what explains that no return is found. */
static void note_slope(lowering *c, ir_node slope, ir_node lambda) {
  static const double HARDLY = 1e-12;
  const ir_node start = ir_constant(c->graph, 0), after = ir_constant(c->graph, HARDLY);
  if (c->mode != LOWER_STEP) return;
  lowered_flow *flow = &c->text.flows[c->text.flow_count - 1];
  ir_substitute(c->graph, &slope, 1, &lambda, &start, 1, &flow->slope);
  ir_substitute(c->graph, &slope, 1, &lambda, &after, 1, &flow->slope_after);
}

/* lambda with f(lambda) = 0: of Newton's method from 0, in one step where f is linear in lambda and
   else in a fixed number: the returns of the usual convex yield functions have converged to
   rounding long before. Where one has not, a point of a continuum has states that are no numbers,
   and of other laws the `flow` check says so. */
static ir_node find_lambda(lowering *c, const stmt *rule, ir_node over, ir_node lambda) {
  enum { NEWTON_STEPS = 8 };
  ir *g = c->graph;
  const ir_node slope = ir_derivative(g, over, lambda),
                falls = ir_binary(g, IR_LT, slope, ir_constant(g, 0));
  const bool linear = !rewrite_depends(g, &slope, 1, &lambda, 1),
             told = c->law->tree->law == LAW_CONTINUUM;
  if (told) note_slope(c, slope, lambda);
  if (told && linear) return found_at_once(c, over, slope, lambda);
  ir_node next = ir_sub(g, lambda, ir_div(g, over, ir_select(g, falls, slope, ir_constant(g, -1))));
  next = ir_select(g, falls, next, lambda);
  ir_node found = ir_constant(g, 0);
  for (int k = 0; k < (linear ? 1 : NEWTON_STEPS); k++) {
    ir_substitute(g, &next, 1, &lambda, &found, 1, &found);
    if (ir_count(g) > MOST_NODES)
      return lower_failed_value(c, rule->where,
                                "with its return written out the law is too large to compile")
          .of[0];
  }
  if (!told) return found;
  ir_node doubt = lower_zero_if(g, has_returned(g, over));
  ir_substitute(g, &doubt, 1, &lambda, &found, 1, &doubt);
  return ir_add(g, found, doubt);
}

/* `flow x along direction returned when f >= 0`: x = old + lambda direction with f(x) = 0, what
   neighbours have being frozen. */
static components flow_returned(lowering *c, const stmt *rule, components old,
                                components direction) {
  ir *g = c->graph;
  ir_node over = overstress_of(c, rule->when);
  if (over == IR_NONE)
    return lower_failed_value(c, rule->where,
                              "a returned flow goes back to where its guard is an equality: write "
                              "`returned when f >= 0`");
  ir_node when = before_flow(c, lower_expr(c, rule->when), NULL), *what, *stand_in;
  note_flow(c, rule, when);
  const int frozen = lower_freeze_neighbours(c, &over, &what, &stand_in);
  ir_node lambda = ir_input(g, IR_FROM_FIELD, 2 * c->law->fields.count, "lambda",
                            !ir_is_uniform(g, over) ? ir_place(g, over) : ON_BOND);
  components moved = along(g, old, lambda, direction);
  ir_substitute(g, &over, 1, old.of, moved.of, old.count, &over);
  if (ir_place(g, over) > ON_PARTICLE && lower_moves_a_sum(g, over, lambda))
    return lower_failed_value(
        c, rule->where,
        "the flow toward one neighbour would change the guards of all others: a guard "
        "that goes over the family must be one for the whole particle");
  ir_node found = find_lambda(c, rule, over, lambda);
  if (c->failed) return old;
  ir_substitute(g, &found, 1, stand_in, what, frozen, &found);
  return chosen(g, when, along(g, old, found, direction), old);
}

/* `flow x by expr when guard`: one increment a step. */
static components flow_once(lowering *c, const stmt *rule, components old, components increment) {
  if (rule->returned) return flow_returned(c, rule, old, increment);
  const components flown = along(c->graph, old, ir_constant(c->graph, 1), increment);
  ir_node when = rule->when ? lower_expr(c, rule->when) : IR_NONE;
  note_flow(c, rule, when);
  return rule->when ? chosen(c->graph, when, flown, old) : flown;
}

/* A field on bonds has one value, which both ends must find: of a parameter that differs from
   particle to particle its rule reads the mean of both. What goes over a family, or is the
   neighbour's, stays. */
static ir_node of_both_ends(lowering *c, ir_node value) {
  const law_variation *v = c->variation;
  ir *g = c->graph;
  const int nodes = ir_count(g);
  if (v->varying_count == 0 && !v->sizes) return value;
  ir_substitution *s = ir_substitution_new(g);
  unsigned char *marks = must_calloc((size_t)nodes + 1, 1);
  ir_mark(g, &value, 1, marks);
  for (ir_node n = 0; n < nodes; n++)
    if (marks[n] && (ir_operation(g, n) == IR_NEIGHBOUR || ir_is_reduction(ir_operation(g, n))))
      ir_substitution_add(s, n, n);
  for (int k = v->sizes ? -1 : 0; k < v->varying_count - v->before_count; k++) {
    const ir_node mine =
        k < 0 ? kinematics_input(g, ENDS_SIZE_I) : lower_own_parameter(c, v->varying[k]);
    ir_substitution_add(s, mine, half(g, ir_add(g, mine, ir_unary(g, IR_NEIGHBOUR, mine))));
  }
  value = ir_substitution_apply(s, value);
  ir_substitution_free(s);
  free(marks);
  return value;
}

/* The inputs at hand, what leaves the plane among them. */
static components old_of(const lowering *c, const symbol *s) {
  components old = {.count = s->shape == SHAPE_TENSOR   ? TENSOR_COUNT
                             : s->shape == SHAPE_VECTOR ? VECTOR_COMPONENT_COUNT
                                                        : 1};
  for (int k = 0; k < old.count; k++)
    if (law_field_of(s, k) >= 0) old.of[k] = lower_field(c->graph, c->law, law_field_of(s, k));
  return s->deviator ? tensor_as_deviator(c->graph, old) : old;
}

static void set_rule(lowering *c, const stmt *rule, int field, ir_node old, ir_node value) {
  const symbol *s = c->law->fields.items[field];
  if (s->component_of && s->component_of->shape == SHAPE_TENSOR &&
      lower_is_none(c->law, s->component))
    value = ir_constant(c->graph, 0);
  if (s->place == ON_BOND && lower_is_state_law(c)) value = of_both_ends(c, value);
  if (c->mode == LOWER_STEP) c->text.rules[field] = value;
  if (s->kind == SYMBOL_DAMAGE) value = clamp_damage(c, s->place, old, value);
  lower_name_node(c->graph, value, s->name, rule->where);
  c->rule[field] = value;
  c->rule_order[c->rule_count++] = field;
}

/* Over a step in time; the rates at its end are kept. */
static components go_on(lowering *c, const stmt *rule, components old, components rate) {
  components rate_before = {.count = old.count}, rate_after;
  for (int k = 0; k < old.count; k++) {
    const int field = law_field_of(rule->symbol, k);
    rate_before.of[k] =
        field < 0 ? IR_NONE : lower_field(c->graph, c->law, law_rate_field(c->law, field));
  }
  const components now = lower_rate(c, rule, old, rate, rate_before, &rate_after);
  for (int k = 0; k < old.count && !c->failed; k++) {
    const int field = law_field_of(rule->symbol, k);
    if (field < 0) continue;
    set_rule(c, rule, law_rate_field(c->law, field), rate_before.of[k], rate_after.of[k]);
  }
  return now;
}

static void lower_field_rule(lowering *c, const stmt *rule) {
  const symbol *s = rule->symbol;
  if (c->mode == LOWER_FROZEN) return;
  if (s->shape == SHAPE_BENDING && c->law->bends_in_space) {
    lower_fail(c, s->where,
               "a state that is a bending quantity would have to turn with its bond "
               "in space: that cannot be compiled; keep a number, such as its `norm`");
    return;
  }
  const components old = old_of(c, s);
  components value = lower_value(c, rule->value);
  if (!c->failed && value.count != old.count && value.count != 1)
    lower_fail(c, rule->where, "this rule gives something else than what the state is");
  for (; value.count < old.count; value.count++) /* 0 is a tensor of zeros, too */
    value.of[value.count] = value.of[0];
  if (rule->kind == STMT_FLOW) value = flow_once(c, rule, old, value);
  const components rate = value;
  if (rule->kind == STMT_RATE) value = go_on(c, rule, old, value);
  for (int k = 0; k < old.count && !c->failed; k++) {
    if (law_field_of(s, k) < 0) continue;
    set_rule(c, rule, law_field_of(s, k), old.of[k], value.of[k]);
    if (rule->kind == STMT_RATE && c->mode == LOWER_STEP)
      c->text.rules[law_field_of(s, k)] = rate.of[k];
  }
}

static void lower_rule(lowering *c, const stmt *rule) {
  const symbol *s = rule->symbol;
  bool field = s && (s->kind == SYMBOL_STATE || s->kind == SYMBOL_DAMAGE);
  if (field && rule == s->rule)
    lower_field_rule(c, rule);
  else if (!field && s && rule->value && rule->kind < STMT_GROW && rule->kind != STMT_PARAMETER &&
           rule->kind != STMT_FUNCTION && rule->kind != STMT_OPTION && !lower_binding_of(c, s)) {
    components v = lower_value(c, rule->value);
    lower_name_value(c, v, s->name, rule->where);
    lower_bind(c, s, v);
  }
}

/* --- results ---------------------------------------------------------------------------------- */

/* Of a symbol; of count 0 without one. */
static components components_of(const lowering *c, const symbol *s) {
  const components *known = s ? lower_binding_of(c, s) : NULL;
  return known ? *known : (components){0};
}

/* Value of a symbol that is one number, or IR_NONE. */
static ir_node value_of(const lowering *c, const symbol *s) {
  const components v = components_of(c, s);
  return v.count == 1 ? v.of[0] : IR_NONE;
}

static ir_node result_node(lowering *c, law_result which) {
  return value_of(c, c->law->results[which]);
}

/* At fixed fields the energy's derivative: N = dW/dL, where the stretch is (L - s)/s. */
static ir_node force_of_energy(lowering *c, ir_node W) {
  ir *g = c->graph;
  ir_node by_stretch = ir_derivative(g, W, lower_quantity(g, QUANTITY_STRETCH));
  ir_node by_length = ir_derivative(g, W, lower_quantity(g, QUANTITY_LENGTH));
  return ir_add(g, ir_div(g, by_stretch, lower_quantity(g, QUANTITY_S)), by_length);
}

static ir_node end_moment(lowering *c, law_result which, ir_node W, builtin_quantity theta,
                          int axis) {
  ir *g = c->graph;
  const components moment = components_of(c, c->law->results[which]),
                   shear = components_of(c, c->law->results[RESULT_V]);
  if (axis < moment.count) return moment.of[axis];
  if (axis < shear.count) {
    const ir_node two = ir_constant(g, 2), length = lower_quantity(g, QUANTITY_LENGTH);
    return ir_div(g, ir_mul(g, shear.of[axis], length), two);
  }
  if (W != IR_NONE) return ir_derivative(g, W, lower_bending(g, c->law, theta, axis));
  return lower_fail(c, c->law->tree->name_where, "the law gives no end moments");
}

/* A bond whose law says nothing of twisting does not resist it. */
static ir_node twisting_moment(lowering *c, ir_node W) {
  const ir_node given = result_node(c, RESULT_T);
  if (given != IR_NONE) return given;
  return W != IR_NONE ? ir_derivative(c->graph, W, lower_quantity(c->graph, QUANTITY_TWIST))
                      : ir_constant(c->graph, 0);
}

static void lower_moments(lowering *c, lowered_law *out) {
  for (int k = 0; k < lower_bending_axes(c->law); k++) {
    out->M_i[k] = end_moment(c, RESULT_M_I, out->W, QUANTITY_THETA_I, k);
    out->M_j[k] = end_moment(c, RESULT_M_J, out->W, QUANTITY_THETA_J, k);
  }
  if (c->law->twists) out->T = twisting_moment(c, out->W);
}

/* N along the bar and V across it, as the axial force and the end moments of the bond. */
static void lower_forces_of_slip(lowering *c, ir_node N, lowered_law *out) {
  ir *g = c->graph;
  const components V = components_of(c, c->law->results[RESULT_V]);
  const slip_work w = lower_slip_work(c, N, &V);
  out->N = lower_slip_settle(g, &w, force_of_energy(c, w.energy));
  for (int k = 0; k < lower_bending_axes(c->law); k++) {
    const ir_node by_i = lower_bending(g, c->law, QUANTITY_THETA_I, k),
                  by_j = lower_bending(g, c->law, QUANTITY_THETA_J, k);
    out->M_i[k] = lower_slip_settle(g, &w, ir_derivative(g, w.energy, by_i));
    out->M_j[k] = lower_slip_settle(g, &w, ir_derivative(g, w.energy, by_j));
  }
  if (c->law->twists) out->T = ir_constant(g, 0);
}

static void lower_forces_of_bond(lowering *c, ir_node N, lowered_law *out) {
  out->N = N != IR_NONE        ? N
           : out->W != IR_NONE ? force_of_energy(c, out->W)
                               : lower_fail(c, c->law->tree->name_where, "the law gives no force");
  if (law_kind_turns(c->law->tree->law)) lower_moments(c, out);
}

static void lower_bond_results(lowering *c, lowered_law *out) {
  const ir_node N = result_node(c, RESULT_N);
  const bool slips = c->law->tree->law == LAW_SLIP_BOND && N != IR_NONE;
  (slips ? lower_forces_of_slip : lower_forces_of_bond)(c, N, out);
  static const char *const of_i[] = {"M_ix", "M_iy", "M_iz"}, *const of_j[] = {"M_jx", "M_jy",
                                                                               "M_jz"};
  const bool space = c->law->bends_in_space;
  span nowhere = {0, 0, 0};
  lower_name_node(c->graph, out->N, "N", nowhere);
  for (int k = 0; k < BENDING_AXES; k++)
    lower_name_node(c->graph, out->M_i[k], space ? of_i[k] : "M_i", nowhere);
  for (int k = 0; k < BENDING_AXES; k++)
    lower_name_node(c->graph, out->M_j[k], space ? of_j[k] : "M_j", nowhere);
  lower_name_node(c->graph, out->T, "T", nowhere);
}

/* What the law gives is the particle's, and where that is of another law, nothing. What the law
   itself reads of its force state, a stress say, stays whole. */
static void take_share(ir *g, lowered_law *out) {
  const ir_node share = kinematics_input(g, ENDS_SHARE_I);
  if (out->F != IR_NONE) out->F = ir_mul(g, share, out->F);
  for (int d = 0; d < FORCE_AXES; d++)
    if (out->F_of[d] != IR_NONE) out->F_of[d] = ir_mul(g, share, out->F_of[d]);
  if (out->W != IR_NONE) out->W = ir_mul(g, share, out->W);
}

/* In the plane what leaves it is nothing. */
static void lower_force_vector(lowering *c, const stmt *given, const components *F,
                               lowered_law *out) {
  static const char *const names[FORCE_AXES] = {"F_x", "F_y", "F_z"};
  for (int d = 0; d < lower_dimensions(c->law); d++) {
    out->F_of[d] = F->of[d];
    if (lower_is_per_volumes(given->symbol->dim))
      out->F_of[d] = lower_force_of_density(c->graph, c->law, out->F_of[d]);
    lower_name_node(c->graph, out->F_of[d], names[d], (span){0, 0, 0});
  }
  if (c->variation->shares) take_share(c->graph, out);
}

static void lower_force_state(lowering *c, lowered_law *out) {
  const stmt *given = law_force_state(c->law);
  const components vector = components_of(c, given ? given->symbol : NULL);
  if (vector.count == VECTOR_COMPONENT_COUNT) {
    lower_force_vector(c, given, &vector, out);
    return;
  }
  if (!given && out->W != IR_NONE && law_reads(c->law, QUANTITY_U)) {
    lower_force_vector_of_energy(c, out->W, out->F_of);
    if (c->variation->shares) take_share(c->graph, out);
    return;
  }
  out->F = given ? value_of(c, given->symbol) : IR_NONE;
  out->along_reference = given && given->along_reference;
  if (out->F == IR_NONE && out->W == IR_NONE)
    out->F = lower_fail(c, c->law->tree->name_where, "the law gives no force state");
  else if (out->F == IR_NONE)
    out->F = lower_force_state_of_energy(c, out->W);
  else if (lower_is_per_volumes(given->symbol->dim))
    out->F = lower_force_of_density(c->graph, c->law, out->F);
  if (c->variation->shares) take_share(c->graph, out);
  lower_name_node(c->graph, out->F, "F", (span){0, 0, 0});
}

/* sigma = dW/dstrain where the law gives the energy alone; a shear stands in it twice. */
static void lower_stress(lowering *c, lowered_law *out) {
  ir *g = c->graph;
  static const char *const names[] = {"sigma_xx", "sigma_yy", "sigma_zz",
                                      "sigma_xy", "sigma_yz", "sigma_xz"};
  const components given = components_of(c, c->law->results[RESULT_SIGMA]);
  for (int k = 0; k < LOWERED_STRESSES; k++) {
    const ir_node strain = lower_point_strain(g, c->law, k, false);
    if (given.count == TENSOR_COUNT)
      out->sigma[k] = given.of[k];
    else if (given.count == 1) /* stress sigma = 0 */
      out->sigma[k] = given.of[0];
    else if (ir_operation(g, strain) == IR_CONSTANT)
      out->sigma[k] = strain;
    else
      out->sigma[k] = ir_derivative(g, out->W, strain);
    if (given.count == 0 && k >= TENSOR_XY) out->sigma[k] = half(g, out->sigma[k]);
    lower_name_node(g, out->sigma[k], names[k], (span){0, 0, 0});
  }
}

static void lower_tip(lowering *c, lowered_law *out) {
  static const char *const names[LOWERED_TIP] = {"grow", "toward", "speed"};
  for (int k = 0; k < LOWERED_TIP; k++) {
    const symbol *given = c->law->results[RESULT_GROW + k];
    out->tip[k] = lower_expr(c, given->rule->value);
    if (k == 0) { /* a truth value as a number */
      const ir_node zero = ir_constant(c->graph, 0);
      out->tip[k] = ir_select(c->graph, out->tip[k], ir_constant(c->graph, 1), zero);
    }
    lower_name_node(c->graph, out->tip[k], names[k], given->rule->where);
  }
}

/* A stretch, or a strain that may be the number 0; what leaves the plane is none. */
static void lower_rest_state(lowering *c, lowered_law *out) {
  const components v = components_of(c, c->law->rest);
  if (c->law->tree->law != LAW_CONTINUUM) {
    out->rest = value_of(c, c->law->rest);
    return;
  }
  for (int k = 0; k < LOWERED_STRESSES; k++)
    out->rest_strain[k] =
        lower_is_none(c->law, k) ? ir_constant(c->graph, 0) : v.of[v.count == 1 ? 0 : k];
}

static void lower_results(lowering *c, lowered_law *out) {
  const symbol_list *outputs = &c->law->outputs;
  out->W = result_node(c, RESULT_W);
  if (c->law->rest) lower_rest_state(c, out);
  if (lower_is_state_law(c))
    lower_force_state(c, out);
  else if (c->law->tree->law == LAW_CONTINUUM)
    lower_stress(c, out);
  else if (c->law->tree->law == LAW_CRACK)
    lower_tip(c, out);
  else
    lower_bond_results(c, out);
  for (int k = 0; k < outputs->count; k++) {
    out->outputs[k] = value_of(c, outputs->items[k]);
    if (out->outputs[k] == IR_NONE)
      out->outputs[k] =
          lower_fail(c, outputs->items[k]->where,
                     "an output is a number: give the parts of a tensor or vector that matter, "
                     "such as `principal(sigma, 1)` or `v[x]`");
  }
}

static void resolve_text(lowering *c, const ir_node *from, const ir_node *to, int pairs) {
  ir *g = c->graph;
  lowered_text *t = &c->text;
  if (c->mode != LOWER_STEP) return;
  int fields = c->law->fields.count,
      count = fields + t->line_count + t->place_count + 4 * t->flow_count;
  ir_node *all = must_alloc(((size_t)count + 1) * sizeof *all), *at = all;
  for (int k = 0; k < fields; k++)
    *at++ = t->rules[k];
  for (int k = 0; k < t->line_count; k++)
    *at++ = t->lines[k].guard;
  for (int k = 0; k < t->place_count; k++)
    *at++ = t->places[k].node;
  for (int k = 0; k < t->flow_count; k++) {
    *at++ = t->flows[k].when;
    *at++ = t->flows[k].overstress;
    *at++ = t->flows[k].slope;
    *at++ = t->flows[k].slope_after;
  }
  ir_substitute(g, all, count, from, to, pairs, all);
  at = all;
  for (int k = 0; k < fields; k++)
    t->rules[k] = *at++;
  for (int k = 0; k < t->line_count; k++)
    t->lines[k].guard = *at++;
  for (int k = 0; k < t->place_count; k++)
    t->places[k].node = *at++;
  for (int k = 0; k < t->flow_count; k++) {
    t->flows[k].when = *at++;
    t->flows[k].overstress = *at++;
    t->flows[k].slope = *at++;
    t->flows[k].slope_after = *at++;
  }
  free(all);
}

static void *keep(arena *memory, void *items, int count, size_t size) {
  void *kept = arena_alloc(memory, ((size_t)count + 1) * size);
  if (count) memcpy(kept, items, (size_t)count * size);
  free(items);
  return kept;
}

/* Puts the rules in place of the opaque new values. A rule reads new values of rules above it. */
static void resolve_fields(lowering *c, lowered_law *out) {
  ir *g = c->graph;
  const size_t fields = (size_t)c->law->fields.count;
  ir_node *from = must_alloc((2 * fields + 1) * sizeof *from);
  ir_node *to = must_alloc((2 * fields + 1) * sizeof *to);
  ir_substitution *known = ir_substitution_new(g);
  int pairs = kept_fields(c, from, to);
  for (int k = 0; k < pairs; k++)
    ir_substitution_add(known, from[k], to[k]);
  for (int k = 0; k < c->rule_count; k++) { /* every field has a rule: the checker sees to that */
    int f = c->rule_order[k];
    out->fields[f] = ir_substitution_apply(known, c->rule[f]);
    lower_name_node(g, out->fields[f], c->law->fields.items[f]->name,
                    c->law->fields.items[f]->rule->where);
    from[pairs] = c->new_value[f];
    to[pairs] = out->fields[f];
    ir_substitution_add(known, from[pairs], to[pairs]);
    pairs++;
  }
  ir_substitution_free(known);
  ir_node *results[LOWERED_FORCES + 2 + LOWERED_STRESSES];
  int count = lowered_forces(out, results);
  if (out->W != IR_NONE) results[count++] = &out->W;
  if (out->rest != IR_NONE) results[count++] = &out->rest;
  for (int k = 0; k < LOWERED_STRESSES && out->rest_strain[0] != IR_NONE; k++)
    results[count++] = &out->rest_strain[k];
  for (int k = 0; k < count; k++)
    ir_substitute(g, results[k], 1, from, to, pairs, results[k]);
  ir_substitute(g, out->outputs, c->law->outputs.count, from, to, pairs, out->outputs);
  resolve_text(c, from, to, pairs);
  free(from);
  free(to);
}

/* By a state above, say. */
static void refuse_moving_rest(lowering *c, const lowered_law *out) {
  ir *g = c->graph;
  static const builtin_quantity motions[] = {QUANTITY_STRETCH, QUANTITY_STRETCH_RATE,
                                             QUANTITY_LENGTH, QUANTITY_TWIST};
  enum { MOTIONS = sizeof motions / sizeof *motions };
  ir_node moving[MOTIONS + 2 * BENDING_AXES];
  int count = 0;
  for (int k = 0; k < MOTIONS; k++)
    moving[count++] = lower_quantity(g, motions[k]);
  for (int k = 0; k < lower_bending_axes(c->law); k++) {
    moving[count++] = lower_bending(g, c->law, QUANTITY_THETA_I, k);
    moving[count++] = lower_bending(g, c->law, QUANTITY_THETA_J, k);
  }
  if (out->rest != IR_NONE && rewrite_depends(g, &out->rest, 1, moving, count))
    lower_fail(c, c->law->rest->where, "the rest stretch may not follow the bond's own motion");
  if (out->rest_strain[0] == IR_NONE) return;
  ir_node of_point[2 * POINT_STRAINS];
  for (int k = 0; k < 2 * POINT_STRAINS; k++)
    of_point[k] = point_input_node(g, k);
  if (rewrite_depends(g, out->rest_strain, LOWERED_STRESSES, of_point, 2 * POINT_STRAINS))
    lower_fail(c, c->law->rest->where, "the rest strain may not follow the point's own motion");
}

/* Stands for the new value of field k until all rules are known. */
static ir_node opaque_field(ir *g, const law *l, int k) {
  const symbol *s = l->fields.items[k];
  return ir_input(g, IR_FROM_FIELD, l->fields.count + k, s->name, s->place);
}

bool lower_law(const law *l, ir *g, lower_mode mode, arena *memory, lowered_law *out,
               diagnostics *d) {
  return lower_law_varying(l, g, mode, &(law_variation){.varying_count = 0}, memory, out, d);
}

bool lower_law_varying(const law *l, ir *g, lower_mode mode, const law_variation *v, arena *memory,
                       lowered_law *out, diagnostics *d) {
  int fields = l->fields.count;
  size_t field_bytes = ((size_t)fields + 1) * sizeof(ir_node);
  lowering c = {.law = l, .graph = g, .mode = mode, .variation = v, .memory = memory, .said = d};
  *out = (lowered_law){.N = IR_NONE, .T = IR_NONE, .F = IR_NONE, .W = IR_NONE, .rest = IR_NONE};
  for (int k = 0; k < BENDING_AXES; k++)
    out->M_i[k] = out->M_j[k] = IR_NONE;
  for (int k = 0; k < FORCE_AXES; k++)
    out->F_of[k] = IR_NONE;
  for (int k = 0; k < LOWERED_STRESSES; k++)
    out->sigma[k] = out->rest_strain[k] = IR_NONE;
  for (int k = 0; k < LOWERED_TIP; k++)
    out->tip[k] = IR_NONE;
  c.text.rules = arena_alloc(memory, field_bytes);
  c.new_value = must_alloc(field_bytes);
  c.rule = must_alloc(field_bytes);
  c.rule_order = must_alloc(((size_t)fields + 1) * sizeof *c.rule_order);
  out->fields = arena_alloc(memory, field_bytes);
  out->outputs = arena_alloc(memory, ((size_t)l->outputs.count + 1) * sizeof(ir_node));
  for (int k = 0; k < fields; k++) {
    c.new_value[k] = mode == LOWER_FROZEN ? lower_field(g, l, k) : opaque_field(g, l, k);
    c.text.rules[k] = out->fields[k] = lower_field(g, l, k);
  }
  for (int k = 0; k < l->rule_count && !c.failed; k++)
    lower_rule(&c, l->rules[k]);
  if (!c.failed) lower_results(&c, out);
  if (!c.failed && mode != LOWER_FROZEN) resolve_fields(&c, out);
  if (!c.failed) refuse_moving_rest(&c, out);
  lowered_text *t = &c.text;
  t->lines = keep(memory, t->lines, t->line_count, sizeof *t->lines);
  t->places = keep(memory, t->places, t->place_count, sizeof *t->places);
  t->flows = keep(memory, t->flows, t->flow_count, sizeof *t->flows);
  out->text = c.text;
  free(c.bound);
  free(c.new_value);
  free(c.rule);
  free(c.rule_order);
  return !c.failed;
}

ir_node lower_bound(ir *g, const law *l, const expr *bound, double infinite, diagnostics *d) {
  if (!bound) return ir_constant(g, infinite);
  arena *memory = arena_new();
  const law_variation none = {.varying_count = 0};
  lowering c = {
      .law = l, .graph = g, .mode = LOWER_STEP, .variation = &none, .memory = memory, .said = d};
  ir_node n = lower_expr(&c, bound);
  free(c.bound);
  free(c.text.lines);
  free(c.text.places);
  arena_free(memory);
  return c.failed ? IR_NONE : n;
}
