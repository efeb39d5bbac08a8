#include "generator/plan/plan_points.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/semantics/law_reads.h"
#include "generator/ir/derive.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/lower_inputs.h"
#include "generator/lower/lowering.h"
#include "generator/lower/point_inputs.h"
#include "generator/plan/plan_given.h"
#include "generator/plan/plan_losses.h"
#include "generator/plan/plan_roots.h"
#include "generator/plan/point_rest.h"

enum { MOST_STRAINS = PL_MAX_STRAINS, MOST_TANGENTS = MOST_STRAINS * MOST_STRAINS };

typedef struct planner {
  kernel_plan *plan;
  ir *graph;
  int strains;                                      /* 3 in the plane, 6 in space */
  ir_node strain[MOST_STRAINS], rate[MOST_STRAINS]; /* what a kernel reads */
  ir_node z, z_rate;                                /* along z, in the plane; else IR_NONE */
  lowered_law step, frozen;
  ir_node tangent[MOST_TANGENTS];
  ir_node rest[MOST_STRAINS + 1]; /* of a law with states: look_at_rest */
  int rest_count;
  /* Of a law with a rest strain: that of the fields at hand, for which `frozen` has a stand-in. */
  ir_node rest_at_hand[TENSOR_COUNT];
} planner;

/* --- the rest strain -------------------------------------------------------------------------- */

static bool has_rest(const planner *p) {
  return p->frozen.rest_strain[0] != IR_NONE;
}

/* What is kept and what is lost to states is compared at one rest strain. */
static void stand_in_for_rest(planner *p) {
  static const char *const names[TENSOR_COUNT] = {"rest_xx", "rest_yy", "rest_zz",
                                                  "rest_xy", "rest_yz", "rest_xz"};
  for (int k = 0; k < TENSOR_COUNT; k++) {
    p->rest_at_hand[k] = p->frozen.rest_strain[k];
    p->frozen.rest_strain[k] =
        ir_input(p->graph, IR_FROM_FIELD, p->plan->law->fields.count + k, names[k], ON_POINT);
  }
}

/* From strains as the law has them to those of the body. */
static void take_off_rest(planner *p, const lowered_law *of, ir_node *node) {
  ir_node measured[MOST_STRAINS];
  if (!has_rest(p) || *node == IR_NONE) return;
  for (int k = 0; k < p->strains; k++)
    measured[k] =
        ir_sub(p->graph, p->strain[k], of->rest_strain[point_component(p->plan->dimensions, k)]);
  ir_substitute(p->graph, node, 1, p->strain, measured, p->strains, node);
}

/* With the rest strain of the fields at hand. */
static ir_node at_rest_at_hand(planner *p, ir_node n) {
  if (!has_rest(p) || n == IR_NONE) return n;
  ir_substitute(p->graph, &n, 1, p->frozen.rest_strain, p->rest_at_hand, TENSOR_COUNT, &n);
  return n;
}

/* --- the third direction ---------------------------------------------------------------------- */

/* All that a law gives, as places that may be changed. */
static int all_of(const planner *p, lowered_law *of, ir_node **all) {
  const law *l = p->plan->law;
  int count = lowered_forces(of, all);
  if (of->W != IR_NONE) all[count++] = &of->W;
  for (int k = 0; k < l->fields.count; k++)
    all[count++] = &of->fields[k];
  for (int k = 0; k < l->outputs.count; k++)
    all[count++] = &of->outputs[k];
  return count;
}

static ir_node **places_for(const planner *p) {
  const law *l = p->plan->law;
  return must_alloc(
      ((size_t)LOWERED_FORCES + 2 + (size_t)l->fields.count + (size_t)l->outputs.count) *
      sizeof(ir_node *));
}

/* z and its rate are these. */
static void settle(planner *p, lowered_law *of, ir_node z, ir_node z_rate) {
  const ir_node from[] = {p->z, p->z_rate}, to[] = {z, z_rate};
  ir_node **all = places_for(p);
  const int count = all_of(p, of, all);
  for (int k = 0; k < count; k++)
    ir_substitute(p->graph, all[k], 1, from, to, 2, all[k]);
  free(all);
}

/* How sigma_zz depends on z. */
typedef struct along_z {
  ir_node stress, slope;
  bool affine;
} along_z;

static along_z along_z_of(planner *p, ir_node sigma_zz) {
  along_z a = {sigma_zz, ir_derivative(p->graph, sigma_zz, p->z), false};
  a.affine = !rewrite_depends(p->graph, &a.slope, 1, &p->z, 1);
  return a;
}

/* That of the states at hand, where it is known and above 0; else 0, by which nothing is found. */
static ir_node slope_at_hand(planner *p, const along_z *at_hand) {
  ir *g = p->graph;
  const ir_node zero = ir_constant(g, 0), slope = at_hand->slope;
  if (!at_hand->affine) return zero;
  if (ir_is_uniform(g, slope)) return slope;
  return ir_select(g, ir_binary(g, IR_LT, zero, slope), slope, zero);
}

/* A slope to divide by. Where its own is next to nothing or negative (a point that has broken, the
   apex of a cone) it is that of the states at hand. What is the same everywhere stays. */
static ir_node safe_slope(planner *p, const along_z *a, const along_z *at_hand) {
  static const double NOTHING = 1e-3; /* of the slope of the states at hand */
  ir *g = p->graph;
  if (ir_is_uniform(g, a->slope)) return a->slope;
  const ir_node other = slope_at_hand(p, at_hand),
                least = ir_mul(g, ir_constant(g, at_hand->affine ? NOTHING : 0), other);
  return ir_select(g, ir_binary(g, IR_LT, least, a->slope), a->slope, other);
}

static ir_node newton_step(planner *p, const along_z *a, const along_z *at_hand) {
  ir *g = p->graph;
  return ir_neg(g, ir_div(g, a->stress, safe_slope(p, a, at_hand)));
}

/* z where sigma_zz is affine. */
static ir_node root_of_line(planner *p, const along_z *a) {
  ir *g = p->graph;
  const ir_node zero = ir_constant(g, 0);
  ir_node step = newton_step(p, a, a);
  ir_substitute(g, &step, 1, &p->z, &zero, 1, &step);
  return step;
}

/* Whether more of sigma_zz is left than this part of what is added up to it; of no number, too. */
static ir_node is_left(planner *p, ir_node sigma_zz, double part) {
  ir *g = p->graph;
  const ir_node most = ir_scaled(g, part, rewrite_size(g, sigma_zz));
  return ir_unary(g, IR_NOT, ir_binary(g, IR_LE, ir_unary(g, IR_ABS, sigma_zz), most));
}

/* Whether a step is not yet next to nothing beside the strain. */
static ir_node is_far(planner *p, ir_node step) {
  static const double NEAR = 1e-11; /* behind such a step the next one would be rounding */
  ir *g = p->graph;
  ir_node size = ir_unary(g, IR_ABS, p->strain[0]);
  for (int k = 1; k < p->strains; k++)
    size = ir_add(g, size, ir_unary(g, IR_ABS, p->strain[k]));
  size = ir_scaled(g, NEAR, ir_add(g, size, ir_unary(g, IR_ABS, p->z)));
  return ir_unary(g, IR_NOT, ir_binary(g, IR_LE, ir_unary(g, IR_ABS, step), size));
}

/* The root of sigma_zz(z), searched from the root with the states at hand where that is found in
   one step, else from 0; z itself counts for nothing where sigma_zz does not depend on it. */
static ir_node strain_without_stress(planner *p, ir_node sigma_zz, ir_node sigma_zz_at_hand) {
  ir *g = p->graph;
  const along_z a = along_z_of(p, sigma_zz), at_hand = along_z_of(p, sigma_zz_at_hand);
  const ir_node sought = ir_sought(g);
  ir_node from = ir_constant(g, 0);
  if (ir_is_number(g, a.slope, 0)) return from;
  if (a.affine) return root_of_line(p, &a);
  if (at_hand.affine && !ir_is_number(g, at_hand.slope, 0)) from = root_of_line(p, &at_hand);
  const ir_node step = newton_step(p, &a, &at_hand);
  ir_node of[2] = {step, is_far(p, step)};
  ir_substitute(g, of, 2, &p->z, &sought, 1, of);
  return ir_search(g, from, of[0], of[1]);
}

/* 0 where sigma_zz is as good as none at the z that is found, else not a number
   (explain_point.h). */
static ir_node unless_free(planner *p, ir_node sigma_zz, ir_node z) {
  static const double FREE = 1e-9; /* of what is added up to it */
  ir *g = p->graph;
  ir_node left = is_left(p, sigma_zz, FREE); /* of z itself, not of the way to it */
  ir_substitute(g, &left, 1, &p->z, &z, 1, &left);
  const ir_node good = ir_constant(g, 0);
  return ir_unary(g, IR_SQRT, ir_select(g, left, ir_constant(g, -1), good));
}

/* How z follows a strain of the plane where sigma_zz stays: -D_zb/D_zz. */
static ir_node follows(planner *p, ir_node sigma_zz, ir_node strain) {
  ir *g = p->graph;
  const ir_node by = ir_derivative(g, sigma_zz, strain), slope = ir_derivative(g, sigma_zz, p->z);
  if (ir_is_number(g, slope, 0) || ir_is_number(g, by, 0)) return ir_constant(g, 0);
  const ir_node ratio = ir_neg(g, ir_div(g, by, slope)), zero = ir_constant(g, 0);
  return ir_is_uniform(g, slope) ? ratio
                                 : ir_select(g, ir_binary(g, IR_EQ, slope, zero), zero, ratio);
}

static ir_node at_rest(planner *p, ir_node n) {
  ir_node rates[MOST_STRAINS + 1], out;
  memcpy(rates, p->rate, (size_t)p->strains * sizeof *rates);
  rates[p->strains] = p->z_rate;
  rewrite_zero(p->graph, &n, 1, rates, p->strains + 1, &out);
  return out;
}

/* As z follows the strains of the plane at rest. */
static ir_node rate_along_z(planner *p, ir_node sigma_zz) {
  ir *g = p->graph;
  ir_node sum = ir_constant(g, 0);
  for (int k = 0; k < p->strains; k++)
    sum = ir_add(g, sum, ir_mul(g, follows(p, sigma_zz, p->strain[k]), p->rate[k]));
  return sum;
}

/* The stress by the strain, z being free to follow in plane stress. */
static void find_tangent(planner *p, bool z_is_free) {
  ir *g = p->graph;
  for (int a = 0; a < p->strains; a++)
    for (int b = 0; b < p->strains; b++) {
      const ir_node stress = p->step.sigma[point_component(p->plan->dimensions, a)];
      ir_node D = ir_derivative(g, stress, p->strain[b]);
      if (z_is_free) {
        const ir_node by = follows(p, p->step.sigma[TENSOR_ZZ], p->strain[b]);
        D = ir_add(g, D, ir_mul(g, ir_derivative(g, stress, p->z), by));
      }
      const bool shear = point_component(p->plan->dimensions, b) >= TENSOR_XY;
      p->tangent[a * p->strains + b] = shear ? half(g, D) : D;
    }
}

static bool is_searched(planner *p, ir_node sigma_zz) {
  return !along_z_of(p, sigma_zz).affine;
}

static void settle_plane(planner *p) {
  ir *g = p->graph;
  const bool is_free = p->plan->law->setting == SETTING_PLANE_STRESS;
  const ir_node zero = ir_constant(g, 0);
  lowered_law *both[] = {&p->step, &p->frozen};
  find_tangent(p, is_free);
  for (int k = 0; k < 2; k++) {
    ir_node z = zero, z_rate = zero, doubt = zero;
    if (has_rest(p)) z = ir_neg(g, both[k]->rest_strain[TENSOR_ZZ]); /* in plane strain */
    if (is_free) {
      ir_node sigma_zz = both[k]->sigma[TENSOR_ZZ];
      z_rate = rate_along_z(p, at_rest(p, sigma_zz));
      ir_substitute(g, &sigma_zz, 1, &p->z_rate, &z_rate, 1, &sigma_zz);
      z = strain_without_stress(p, sigma_zz, at_rest(p, p->frozen.sigma[TENSOR_ZZ]));
      ir_substitute(g, &z_rate, 1, &p->z, &z, 1, &z_rate);
      if (k == 0 && is_searched(p, sigma_zz)) doubt = unless_free(p, sigma_zz, z);
    }
    if (k == 0) {
      const ir_node from[] = {p->z, p->z_rate}, to[] = {z, z_rate};
      ir_substitute(g, p->tangent, p->strains * p->strains, from, to, 2, p->tangent);
    }
    settle(p, both[k], z, z_rate);
    both[k]->sigma[TENSOR_XX] = ir_add(g, both[k]->sigma[TENSOR_XX], doubt);
    if (is_free) both[k]->sigma[TENSOR_ZZ] = zero;
  }
}

static ir_node with_new_fields(planner *p, ir_node n) {
  const int fields = p->plan->law->fields.count;
  ir_node *at_hand = must_alloc(((size_t)fields + 1) * sizeof *at_hand), result;
  for (int k = 0; k < fields; k++)
    at_hand[k] = lower_field(p->graph, p->plan->law, k);
  ir_substitute(p->graph, &n, 1, at_hand, p->step.fields, fields, &result);
  free(at_hand);
  return result;
}

/* Which fields the stress of a step is that of; before the third direction is settled, as what z is
   depends on them. */
static force_fields stress_fields(planner *p) {
  bool is_old = true, is_new = true;
  for (int k = 0; k < TENSOR_COUNT; k++) {
    const ir_node used = p->step.sigma[k], old = p->frozen.sigma[k];
    is_old = is_old && used == old;
    is_new = is_new && (old == IR_NONE || used == with_new_fields(p, old));
  }
  for (int k = 0; k < TENSOR_COUNT && has_rest(p); k++) {
    const ir_node used = p->step.rest_strain[k], old = p->rest_at_hand[k];
    is_old = is_old && used == old;
    is_new = is_new && used == with_new_fields(p, old);
  }
  return is_new ? FORCES_OF_NEW : is_old ? FORCES_OF_OLD : FORCES_OF_BOTH;
}

/* Where a point has failed nothing acts and nothing is stored, and its outputs are those without
   stress. */
static void fail_points(planner *p) {
  ir *g = p->graph;
  if (!p->plan->law->failed) return;
  const int at = p->plan->law->failed->index;
  const ir_node zero = ir_constant(g, 0), one = ir_constant(g, 1);
  lowered_law *both[] = {&p->step, &p->frozen};
  for (int k = 0; k < 2; k++) {
    const ir_node failed = k == 0 ? p->step.fields[at] : lower_field(g, p->plan->law, at);
    const ir_node gone = ir_binary(g, IR_LE, one, failed);
    ir_node from[TENSOR_COUNT], to[TENSOR_COUNT];
    int count = 0;
    for (int c = 0; c < TENSOR_COUNT; c++) {
      const ir_node acts = both[k]->sigma[c];
      both[k]->sigma[c] = ir_select(g, gone, zero, acts);
      if (ir_is_uniform(g, acts)) continue;
      from[count] = acts;
      to[count++] = both[k]->sigma[c];
    }
    ir_substitute(g, both[k]->outputs, p->plan->law->outputs.count, from, to, count,
                  both[k]->outputs);
    if (both[k]->W != IR_NONE) both[k]->W = ir_select(g, gone, zero, both[k]->W);
    for (int c = 0; c < p->strains * p->strains && k == 0; c++)
      p->tangent[c] = ir_select(g, gone, zero, p->tangent[c]);
  }
}

/* --- energies --------------------------------------------------------------------------------- */

/* stress : strain, of what a kernel reads; shears count twice. */
static ir_node contract(planner *p, const ir_node *stress, const ir_node *strain) {
  ir *g = p->graph;
  ir_node sum = IR_NONE;
  for (int k = 0; k < p->strains; k++) {
    ir_node term = ir_mul(g, stress[k], strain[k]);
    if (point_component(p->plan->dimensions, k) >= TENSOR_XY)
      term = ir_mul(g, ir_constant(g, 2), term);
    sum = sum == IR_NONE ? term : ir_add(g, sum, term);
  }
  return sum;
}

/* Stresses that a kernel gives with the fields at hand; at zero rate. */
static void frozen_stress(planner *p, bool at_rest, ir_node *stress) {
  for (int k = 0; k < p->strains; k++)
    stress[k] = p->frozen.sigma[point_component(p->plan->dimensions, k)];
  if (at_rest) rewrite_zero(p->graph, stress, p->strains, p->rate, p->strains, stress);
}

static ir_node path_energy(planner *p, const ir_node *stress) {
  static const double at[2] = {0.86113631159405257522, 0.33998104358485626480};
  static const double weight[2] = {0.34785484513745385737, 0.65214515486254614263};
  ir *g = p->graph;
  ir_node sum = IR_NONE;
  for (int point = 0; point < 4; point++) {
    const double sign = point < 2 ? -1 : 1;
    const ir_node fraction = ir_constant(g, 0.5 * (1 + sign * at[point % 2]));
    ir_node there[MOST_STRAINS], here[MOST_STRAINS];
    for (int k = 0; k < p->strains; k++)
      there[k] = ir_mul(g, fraction, p->strain[k]);
    ir_substitute(g, stress, p->strains, p->strain, there, p->strains, here);
    const ir_node part = ir_scaled(g, 0.5 * weight[point % 2], contract(p, here, p->strain));
    sum = sum == IR_NONE ? part : ir_add(g, sum, part);
  }
  return sum;
}

/* Stresses without strain, as far as the graph does not show that they are 0, the one along z where
   it is free: asked before the plane is settled. */
static void look_at_rest(planner *p) {
  ir *g = p->graph;
  ir_node still[2 * MOST_STRAINS + 2], rest[MOST_STRAINS + 1];
  int count = 0, stresses = 0;
  for (int k = 0; k < p->strains; k++) {
    still[count++] = p->strain[k];
    still[count++] = p->rate[k];
    rest[stresses++] = p->frozen.sigma[point_component(p->plan->dimensions, k)];
  }
  if (p->z != IR_NONE) still[count++] = p->z;
  if (p->z_rate != IR_NONE) still[count++] = p->z_rate;
  if (p->plan->law->setting == SETTING_PLANE_STRESS) rest[stresses++] = p->frozen.sigma[TENSOR_ZZ];
  rewrite_zero(g, rest, stresses, still, count, rest);
  for (int k = 0; k < stresses; k++)
    if (!ir_is_number(g, rest[k], 0)) p->rest[p->rest_count++] = rest[k];
}

/* Whether states move the strain without stress. */
static bool states_move(const planner *p) {
  for (int k = 0; k < p->rest_count; k++)
    if (!point_rest_is_none(p->plan, p->rest[k])) return true;
  return false;
}

/* The work from the strain without stress, in plane strain from that without a stress in the plane;
   IR_NONE where it is not known. */
static ir_node work_from_rest(planner *p) {
  ir *g = p->graph;
  ir_node stress[MOST_STRAINS], elastic[MOST_STRAINS];
  frozen_stress(p, true, stress);
  if (p->rest_count > 0) {
    if (point_elastic_strain(p->plan, stress, p->strain, p->strains, elastic))
      return half(g, contract(p, stress, elastic));
    if (states_move(p)) return IR_NONE;
  }
  for (int k = 0; k < p->strains; k++) {
    const double degree = rewrite_degree(g, stress[k], p->strain, p->strains);
    if (degree != 1 && degree != REWRITE_ZERO) return path_energy(p, stress);
  }
  return half(g, contract(p, stress, p->strain));
}

/* At zero rate; IR_NONE: not known. */
static ir_node stored_energy(planner *p) {
  ir_node W = p->frozen.W;
  rewrite_zero(p->graph, &W, 1, p->rate, p->strains, &W);
  return W;
}

/* What the stress does at rest as the strain changes: W/m^3. */
static ir_node still_power(planner *p) {
  ir_node still[MOST_STRAINS];
  frozen_stress(p, true, still);
  return contract(p, still, p->rate);
}

/* What the stress does that vanishes at zero rate: W/m^3. */
static ir_node rate_power(planner *p) {
  ir *g = p->graph;
  ir_node whole[MOST_STRAINS], still[MOST_STRAINS];
  frozen_stress(p, false, whole);
  frozen_stress(p, true, still);
  if (!rewrite_depends(g, whole, p->strains, p->rate, p->strains)) return ir_constant(g, 0);
  for (int k = 0; k < p->strains; k++)
    whole[k] = ir_sub(g, whole[k], still[k]);
  return contract(p, whole, p->rate);
}

/* --- programs --------------------------------------------------------------------------------- */

static void want(planner *p, segment *a, ir_node node, segment_target target, int index) {
  segment_add(p->plan->memory, a,
              (segment_root){.node = node, .target = target, .over = a->kind, .index = index});
}

typedef struct seen_points {
  ir_node stored; /* IR_NONE: not known; it and still_power have a stand-in for the rest strain */
  ir_node rate_power, still_power;
  force_fields stress; /* that of a step */
} seen_points;

static void plan_step(planner *p, const seen_points *t, segment *a) {
  (void)t;
  for (int k = 0; k < PL_STRESSES(p->plan->dimensions); k++)
    want(p, a, p->step.sigma[point_component(p->plan->dimensions, k)], TO_FORCE, k);
  for (int k = 0; k < p->plan->law->fields.count; k++)
    want(p, a, p->step.fields[k], TO_FIELD, k);
}

/* What is stored with the old fields less what is with the new ones, both at the present strain;
   and what that difference is halfway instead, where the step's stress works (plan_losses.h). 0
   where it is not known. */
static ir_node lost_to_states(planner *p, const seen_points *t) {
  ir *g = p->graph;
  if (t->stored == IR_NONE) return ir_constant(g, 0);
  const ir_node stored = at_rest_at_hand(p, t->stored), still = at_rest_at_hand(p, t->still_power),
                kept = at_rest_at_hand(p, with_new_fields(p, t->stored)),
                after = at_rest_at_hand(p, with_new_fields(p, t->still_power));
  const ir_node lost = kept == stored ? ir_constant(g, 0) : ir_sub(g, stored, kept);
  if (t->stress == FORCES_OF_BOTH || after == still) return lost;
  const double part = t->stress == FORCES_OF_NEW ? -0.5 : 0.5;
  const ir_node half_step = ir_scaled(g, part, kinematics_input(g, ENDS_TIME_STEP));
  return ir_add(g, lost, ir_mul(g, half_step, ir_sub(g, still, after)));
}

static ir_node given_by_rest(const planner *p, const seen_points *t) {
  const int rests = has_rest(p) ? TENSOR_COUNT : 0;
  if (!plan_rest_changes(p->plan, p->rest_at_hand, rests)) return ir_constant(p->graph, 0);
  return plan_given_by_rest(p->plan, &(rest_energy){.stored = t->stored,
                                                    .power = t->still_power,
                                                    .stand_in = p->frozen.rest_strain,
                                                    .rest = p->rest_at_hand,
                                                    .rests = rests,
                                                    .new_fields = p->step.fields,
                                                    .forces = t->stress});
}

/* Lost to rates: their power over the step. */
static void plan_ledger(planner *p, const seen_points *t, segment *a) {
  ir *g = p->graph;
  plan_step(p, t, a);
  want(p, a, lost_to_states(p, t), TO_DISSIPATED_STATE, PL_LOST_TO_STATES);
  const ir_node step = kinematics_input(g, ENDS_TIME_STEP);
  want(p, a, ir_mul(g, with_new_fields(p, t->rate_power), step), TO_DISSIPATED_RATE,
       PL_LOST_TO_RATES);
  const ir_node given = given_by_rest(p, t);
  p->plan->works_at_rest = !ir_is_number(g, given, 0);
  if (p->plan->works_at_rest) want(p, a, given, TO_GIVEN_BY_REST, PL_GIVEN_BY_REST);
}

static void plan_observe(planner *p, const seen_points *t, segment *a) {
  const ir_node stored = at_rest_at_hand(p, t->stored);
  want(p, a, stored != IR_NONE ? stored : ir_constant(p->graph, 0), TO_OBSERVED, 0);
  for (int k = 0; k < p->plan->law->outputs.count; k++)
    want(p, a, p->frozen.outputs[k], TO_OBSERVED, 1 + k);
}

static void plan_tangent(planner *p, const seen_points *t, segment *a) {
  (void)t;
  for (int k = 0; k < p->strains * p->strains; k++)
    want(p, a, p->tangent[k], TO_TANGENT, k);
}

/* --- the plan --------------------------------------------------------------------------------- */

/* Everything at once, so that all programs compute a value in the same way. */
static void improve(planner *p, seen_points *t) {
  ir *g = p->graph;
  const law *l = p->plan->law;
  const size_t most =
      (size_t)(2 * (LOWERED_FORCES + 1 + l->fields.count + l->outputs.count) + MOST_TANGENTS + 3);
  ir_node **all = must_alloc(most * sizeof *all), *nodes = must_alloc(most * sizeof *nodes);
  int count = all_of(p, &p->step, all);
  count += all_of(p, &p->frozen, all + count);
  for (int k = 0; k < p->strains * p->strains; k++)
    all[count++] = &p->tangent[k];
  all[count++] = &t->stored;
  all[count++] = &t->rate_power;
  all[count++] = &t->still_power;
  for (int k = 0; k < count; k++)
    nodes[k] = *all[k];
  rewrite_reciprocals(g, nodes, count, nodes);
  rewrite_factors(g, nodes, count, nodes);
  rewrite_fused(g, nodes, count, nodes);
  for (int k = 0; k < count; k++)
    *all[k] = nodes[k];
  free(all);
  free(nodes);
}

/* A field that the law is given may change in time. */
static bool is_given(const planner *p) {
  const law_variation *v = &p->plan->variation;
  for (int k = 0; k < v->varying_count; k++)
    if (symbol_is_field(p->plan->law->parameters.items[v->varying[k]])) return true;
  return false;
}

/* Neither strain, fields, rates nor the size of a cell are in the tangent, and rates are not in the
   stress. */
static bool is_affine(planner *p) {
  ir *g = p->graph;
  const int fields = p->plan->law->fields.count;
  if (fields > 0) return false;
  for (int k = 0; k < p->strains * p->strains; k++)
    if (ir_place(g, p->tangent[k]) > ON_BODY && (is_given(p) || !p->plan->variation.varying_count ||
                                                 ir_place(g, p->tangent[k]) != ON_POINT))
      return false;
  ir_node moving[2 * MOST_STRAINS + 1];
  int count = 0;
  for (int k = 0; k < p->strains; k++) {
    moving[count++] = p->strain[k];
    moving[count++] = p->rate[k];
  }
  moving[count++] = point_input_node(g, POINT_CELL_SIZE);
  if (rewrite_depends(g, p->tangent, p->strains * p->strains, moving, count)) return false;
  for (int k = 0; k < p->strains; k++) {
    const ir_node stress = p->step.sigma[point_component(p->plan->dimensions, k)];
    if (rewrite_depends(g, &stress, 1, p->rate, p->strains)) return false;
  }
  return true;
}

static bool has_stress_without_strain(planner *p) {
  bool has = false;
  for (int k = 0; k < p->strains; k++) {
    ir_node rest = p->step.sigma[point_component(p->plan->dimensions, k)];
    rewrite_zero(p->graph, &rest, 1, p->strain, p->strains, &rest);
    has = has || !ir_is_number(p->graph, rest, 0);
  }
  return has;
}

static bool reads_rates(planner *p) {
  ir_node **all = places_for(p);
  const int count = all_of(p, &p->step, all);
  bool found = false;
  for (int k = 0; k < count && !found; k++)
    found = rewrite_depends(p->graph, all[k], 1, p->rate, p->strains);
  free(all);
  return found;
}

static void point_at_inputs(planner *p) {
  const int dimensions = p->plan->dimensions;
  ir *g = p->graph;
  p->strains = PL_STRAINS(dimensions);
  for (int k = 0; k < p->strains; k++) {
    p->strain[k] = point_input_node(g, POINT_STRAIN + point_component(dimensions, k));
    p->rate[k] = point_input_node(g, POINT_STRAIN_RATE + point_component(dimensions, k));
  }
  if (dimensions == 3) return;
  p->z = point_input_node(g, POINT_STRAIN + TENSOR_ZZ);
  p->z_rate = point_input_node(g, POINT_STRAIN_RATE + TENSOR_ZZ);
}

/* Without W: false. */
static bool tell_no_energy(const law *l, diagnostics *d) {
  diag_report(d, DIAG_STORED_ENERGY, l->tree->name_where,
              "what this law stores is not known: its states move the strain at which it has no "
              "stress, and its stiffness depends on them or on the strain");
  diag_hint(d, "give `energy W`, such as that of the elastic strain, "
               "W = (sigma:(strain - eps_p))/2, and what hardening locks in");
  return false;
}

/* Of a rest strain the work along z counts in plane strain, too: what is stored is that of all
   three directions. */
static bool works_along_z(const planner *p) {
  return has_rest(p) && p->plan->law->setting == SETTING_PLANE_STRAIN;
}

/* Before the plane is settled. */
static void look_before(planner *p) {
  const int strains = p->strains;
  if (works_along_z(p)) {
    p->strain[p->strains] = p->z;
    p->rate[p->strains++] = p->z_rate;
  }
  if (p->plan->law->fields.count > 0) look_at_rest(p);
  if (works_along_z(p) && p->frozen.W == IR_NONE) p->frozen.W = work_from_rest(p);
  p->strains = strains;
}

/* Everything is given by the body's strains. */
static void measure_from_rest(planner *p, seen_points *t) {
  ir_node **all = places_for(p);
  for (int k = all_of(p, &p->step, all) - 1; k >= 0; k--)
    take_off_rest(p, &p->step, all[k]);
  for (int k = all_of(p, &p->frozen, all) - 1; k >= 0; k--)
    take_off_rest(p, &p->frozen, all[k]), *all[k] = at_rest_at_hand(p, *all[k]);
  for (int k = 0; k < p->strains * p->strains; k++)
    take_off_rest(p, &p->step, &p->tangent[k]);
  take_off_rest(p, &p->frozen, &t->stored);
  take_off_rest(p, &p->frozen, &t->still_power);
  take_off_rest(p, &p->frozen, &t->rate_power);
  t->rate_power = at_rest_at_hand(p, t->rate_power);
  free(all);
}

bool plan_points(kernel_plan *plan, diagnostics *d) {
  planner p = {.plan = plan, .graph = plan->graph, .z = IR_NONE, .z_rate = IR_NONE};
  const law_variation *v = &plan->variation;
  if (!lower_law_varying(plan->law, plan->graph, LOWER_STEP, v, plan->memory, &p.step, d) ||
      !lower_law_varying(plan->law, plan->graph, LOWER_FROZEN, v, plan->memory, &p.frozen, d))
    return false;
  point_at_inputs(&p);
  for (int k = 0; k < TENSOR_COUNT && v->measured; k++)
    p.step.rest_strain[k] = p.frozen.rest_strain[k] = IR_NONE;
  if (has_rest(&p)) stand_in_for_rest(&p);
  look_before(&p);
  const force_fields alive = stress_fields(&p),
                     stress = plan->law->failed && alive == FORCES_OF_OLD ? FORCES_OF_BOTH : alive;
  if (plan->dimensions == 3)
    find_tangent(&p, false);
  else
    settle_plane(&p);
  plan->stores = plan->law->nonconservative == NULL;
  if (p.frozen.W == IR_NONE && !works_along_z(&p)) p.frozen.W = work_from_rest(&p);
  if (p.frozen.W == IR_NONE && plan->stores) return tell_no_energy(plan->law, d);
  fail_points(&p);
  seen_points seen = {stored_energy(&p), rate_power(&p), still_power(&p), stress};
  measure_from_rest(&p, &seen);
  plan->affine = is_affine(&p);
  plan->linear = plan->affine && !has_stress_without_strain(&p);
  plan->reads_rates = reads_rates(&p);
  plan->reads_size = law_reads(plan->law, QUANTITY_CELL_SIZE);
  improve(&p, &seen);
  static void (*const program[])(planner *, const seen_points *,
                                 segment *) = {[PROGRAM_STEP] = plan_step,
                                               [PROGRAM_LEDGER] = plan_ledger,
                                               [PROGRAM_OBSERVE] = plan_observe,
                                               [PROGRAM_TANGENT] = plan_tangent};
#define X(task, member) program[task](&p, &seen, plan_single(plan, task, #member, OVER_POINTS));
  POINT_PROGRAMS(X)
#undef X
  return true;
}

bool plan_has_rectangles(const kernel_plan *p) {
  static const double MOST = 128; /* operations of a point: the loop keeps four in registers */
  if (p->form != FORM_POINTS || p->dimensions != 2 || p->flops_per_bond > MOST) return false;
  unsigned char *needed =
      segment_needed(p->graph, plan_segment(p, PROGRAM_LEDGER)); /* the step's and more */
  bool searches = false;
  for (ir_node n = 0; n < ir_count(p->graph); n++)
    searches = searches || (needed[n] && ir_operation(p->graph, n) == IR_SEARCH);
  free(needed);
  return !searches;
}

bool plan_tips(kernel_plan *plan, diagnostics *d) {
  planner p = {.plan = plan, .graph = plan->graph, .z = IR_NONE, .z_rate = IR_NONE};
  if (!lower_law(plan->law, plan->graph, LOWER_STEP, plan->memory, &p.step, d)) return false;
  segment *a = plan_single(plan, PROGRAM_STEP, "tip_look", OVER_POINTS);
  for (int k = 0; k < LOWERED_TIP; k++)
    want(&p, a, p.step.tip[k], TO_OUT, k);
  for (int k = 0; k < plan->law->fields.count; k++)
    want(&p, a, p.step.fields[k], TO_FIELD, k);
  for (int k = 0; k < plan->law->outputs.count; k++)
    want(&p, a, p.step.outputs[k], TO_OBSERVED, k);
  plan->stores = true;
  return true;
}
