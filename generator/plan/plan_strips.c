#include "generator/plan/plan_strips.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/ir/derive.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/law_inputs.h"
#include "generator/lower/lower_energy.h"
#include "generator/lower/lower_inputs.h"
#include "generator/lower/lower_rest.h"
#include "generator/plan/plan_given.h"
#include "generator/plan/plan_roots.h"

typedef struct planner {
  kernel_plan *plan;
  lowered_law step;   /* protectable, reciprocals shared */
  lowered_law frozen; /* as lowered */
  force_fields forces;
} planner;

/* The law in terms of what particles have. */
typedef struct seen_law {
  bond_forces force;
  lowered_law step;
  ir_node stored; /* J, with the fields at hand */
  /* Where the rest stretch has a stand-in: what is stored, and (W) what forces do at rest, if that
     is asked for; the rest stretch with the fields at hand. */
  ir_node held, power, rest;
  ir_node rate_power; /* W, with the fields at hand; IR_NONE */
  ir_node *outputs;   /* with the fields at hand */
} seen_law;

/* --- substitution ----------------------------------------------------------------------------- */

/* One root after the other. */
static void substitute(ir *g, ir_node *nodes, int count, const ir_node *from, const ir_node *to,
                       int pairs) {
  ir_substitution *s = ir_substitution_new(g);
  for (int k = 0; k < pairs; k++)
    ir_substitution_add(s, from[k], to[k]);
  for (int k = 0; k < count; k++)
    if (nodes[k] != IR_NONE) nodes[k] = ir_substitution_apply(s, nodes[k]);
  ir_substitution_free(s);
}

static void substitute_law(ir *g, const law *l, lowered_law *p, const ir_node *from,
                           const ir_node *to, int pairs) {
  ir_node *results[] = {&p->N, &p->M_i[0], &p->M_j[0], &p->T};
  for (size_t k = 0; k < sizeof results / sizeof *results; k++)
    substitute(g, results[k], 1, from, to, pairs);
  substitute(g, p->fields, l->fields.count, from, to, pairs);
}

static ir_node *copy_nodes(arena *memory, const ir_node *nodes, int count) {
  ir_node *copy = arena_alloc(memory, ((size_t)count + 1) * sizeof *copy);
  memcpy(copy, nodes, (size_t)count * sizeof *copy);
  return copy;
}

/* Shares reciprocals among all that a step computes, once for all passes, so that they agree to the
   bit. */
static void share_reciprocals(ir *g, const law *l, lowered_law *p) {
  enum { FORCES = 4 };
  int fields = l->fields.count;
  size_t field_bytes = (size_t)fields * sizeof(ir_node);
  ir_node *all = must_alloc(FORCES * sizeof *all + field_bytes);
  all[0] = p->N;
  all[1] = p->M_i[0]; /* IR_NONE stays IR_NONE */
  all[2] = p->M_j[0];
  all[3] = p->T;
  memcpy(all + FORCES, p->fields, field_bytes);
  rewrite_reciprocals(g, all, FORCES + fields, all);
  p->N = all[0];
  p->M_i[0] = all[1];
  p->M_j[0] = all[2];
  p->T = all[3];
  memcpy(p->fields, all + FORCES, field_bytes);
  free(all);
}

/* --- the law on particles --------------------------------------------------------------------- */

/* Parameters that differ from bond to bond, and the values that a strip brings. */
static int parameter_pairs(const kernel_plan *p, ir_node *from, ir_node *to) {
  const law_variation *v = &p->variation;
  const int count = v->varying_count - v->before_count;
  for (int k = 0; k < count; k++) {
    from[k] = lower_parameter(p->graph, p->law, v->varying[k]);
    to[k] = lower_varying(p->graph, p->law, v, k);
  }
  return count;
}

/* Law-level inputs and the kinematics that take their place. */
static int kinematic_pairs(ir *g, const bond_kinematics *k, ir_node *from, ir_node *to) {
  const ir_node values[PL_STATE_INPUTS] = {k->stretch, k->stretch_rate, k->theta_i, k->theta_j,
                                           k->length, kinematics_advance(g, ON_BOND)};
  int pairs = 0;
  for (int q = 0; q < PL_STATE_INPUTS; q++) {
    if (values[q] == IR_NONE) continue;
    from[pairs] = lower_quantity(g, law_motion[q]);
    to[pairs++] = values[q];
  }
  if (k->twist == IR_NONE) return pairs;
  from[pairs] = lower_quantity(g, QUANTITY_TWIST);
  to[pairs++] = k->twist;
  return pairs;
}

/* Everything at once, and before new fields take the place of those at hand (with_new_fields): all
   passes compute a value in the same way, and energies with old and new fields differ in no bit
   where the fields do not differ. */
static void fuse(planner *p, seen_law *t) {
  const law *l = p->plan->law;
  const int most = PL_MAX_PLANES + 3 + l->fields.count + l->outputs.count;
  ir_node *all = must_alloc((size_t)most * sizeof *all);
  ir_node *const single[] = {&t->force.f_x, &t->force.f_y,  &t->force.moment_i, &t->force.moment_j,
                             &t->stored,    &t->rate_power, &t->force.twisting, &t->power};
  const int singles = (int)(sizeof single / sizeof *single);
  int count = 0;
  for (int k = 0; k < singles; k++)
    all[count++] = *single[k];
  for (int k = 0; k < l->fields.count; k++)
    all[count++] = t->step.fields[k];
  for (int k = 0; k < l->outputs.count; k++)
    all[count++] = t->outputs[k];
  rewrite_factors(p->plan->graph, all, count, all);
  rewrite_fused(p->plan->graph, all, count, all);
  for (int k = 0; k < singles; k++)
    *single[k] = all[k];
  memcpy(t->step.fields, all + singles, (size_t)l->fields.count * sizeof *all);
  memcpy(t->outputs, all + singles + l->fields.count, (size_t)l->outputs.count * sizeof *all);
  free(all);
}

static seen_law see_law(planner *p) {
  ir *g = p->plan->graph;
  const law *l = p->plan->law;
  arena *memory = p->plan->memory;
  const bond_kinematics k = kinematics_bond(g, plan_kind(p->plan) == PL_MICROPOLAR, l->twists);
  seen_law t = {.step = p->step};
  const size_t most = (size_t)(PL_STATE_INPUTS + 1 + p->plan->variation.varying_count);
  ir_node *from = arena_alloc(memory, most * sizeof *from);
  ir_node *to = arena_alloc(memory, most * sizeof *to);
  int pairs = kinematic_pairs(g, &k, from, to);
  pairs += parameter_pairs(p->plan, from + pairs, to + pairs);
  t.step.fields = copy_nodes(memory, p->step.fields, l->fields.count);
  substitute_law(g, l, &t.step, from, to, pairs);
  t.force = kinematics_forces(g, &k, t.step.N, t.step.M_i[0], t.step.M_j[0]);
  t.force.twisting = t.step.T;

  t.stored = lower_stored_energy(g, l, &p->frozen);
  rest_hold(g, l, &p->frozen, &t.stored);
  rewrite_reciprocals(g, &t.stored, 1, &t.stored);
  substitute(g, &t.stored, 1, from, to, pairs);
  t.rate_power = lower_rate_power(g, l, &p->frozen, k.theta_rate_i, k.theta_rate_j, k.twist_rate);
  rest_take_off(g, &p->frozen, &t.rate_power, 1);
  if (t.rate_power != IR_NONE) rewrite_reciprocals(g, &t.rate_power, 1, &t.rate_power);
  substitute(g, &t.rate_power, 1, from, to, pairs);
  t.power = IR_NONE;
  if (plan_rest_changes(p->plan, &p->frozen.rest, p->frozen.rest != IR_NONE))
    t.power = lower_still_power(g, l, &p->frozen, k.theta_rate_i, k.theta_rate_j, k.twist_rate);
  rest_hold(g, l, &p->frozen, &t.power);
  substitute(g, &t.power, 1, from, to, pairs);
  t.outputs = copy_nodes(memory, p->frozen.outputs, l->outputs.count);
  rest_take_off(g, &p->frozen, t.outputs, l->outputs.count);
  rewrite_reciprocals(g, t.outputs, l->outputs.count, t.outputs);
  substitute(g, t.outputs, l->outputs.count, from, to, pairs);
  fuse(p, &t);
  t.rest = p->frozen.rest;
  substitute(g, &t.rest, 1, from, to, pairs);
  t.held = t.stored;
  t.stored = rest_filled_in(g, l, t.rest, t.held);
  return t;
}

/* The same node with the new fields in place of those at hand. */
static ir_node with_new_fields(planner *p, const seen_law *t, ir_node n) {
  ir *g = p->plan->graph;
  int fields = p->plan->law->fields.count;
  ir_node *at_hand = must_alloc(((size_t)fields + 1) * sizeof *at_hand), result;
  for (int k = 0; k < fields; k++)
    at_hand[k] = lower_field(g, p->plan->law, k);
  ir_substitute(g, &n, 1, at_hand, t->step.fields, fields, &result);
  free(at_hand);
  return result;
}

/* --- programs --------------------------------------------------------------------------------- */

static void want(kernel_plan *p, segment *a, ir_node node, segment_target target, int index) {
  segment_add(p->memory, a,
              (segment_root){.node = node, .target = target, .over = a->kind, .index = index});
}

static void plan_step(planner *p, const seen_law *t, segment *a) {
  const ir_node planes[] = {t->force.f_x, t->force.f_y, t->force.moment_i, t->force.moment_j,
                            t->force.twisting};
  for (int k = 0; k < p->plan->force_planes; k++)
    want(p->plan, a, planes[k], TO_FORCE, k);
  for (int k = 0; k < p->plan->law->fields.count; k++)
    want(p->plan, a, t->step.fields[k], TO_FIELD, k);
}

static ir_node given_by_rest(planner *p, const seen_law *t) {
  const kernel_plan *plan = p->plan;
  const bool rests = t->rest != IR_NONE;
  const ir_node stand_in = rests ? rest_stand_in(plan->graph, plan->law) : IR_NONE;
  return plan_given_by_rest(plan, &(rest_energy){.stored = t->held,
                                                 .power = t->power,
                                                 .stand_in = &stand_in,
                                                 .rest = &t->rest,
                                                 .rests = rests,
                                                 .new_fields = t->step.fields,
                                                 .forces = p->forces});
}

/* Energy lost to damage and plastic flow: what the bond held with the old fields less what it holds
   with the new ones, both at the present deformation. Lost to rate terms: their power over the
   step. */
static void plan_ledger(planner *p, const seen_law *t, segment *a) {
  ir *g = p->plan->graph;
  plan_step(p, t, a);
  const ir_node kept = rest_filled_in(g, p->plan->law, t->rest, with_new_fields(p, t, t->held)),
                zero = ir_constant(g, 0);
  ir_node lost = kept == t->stored ? zero : ir_sub(g, t->stored, kept);
  ir_node rate_lost = zero;
  if (t->rate_power != IR_NONE) {
    const ir_node step = kinematics_input(g, ENDS_TIME_STEP);
    rate_lost = ir_mul(g, with_new_fields(p, t, t->rate_power), step);
  }
  want(p->plan, a, lost, TO_DISSIPATED_STATE, 0);
  want(p->plan, a, rate_lost, TO_DISSIPATED_RATE, 0);
  const ir_node given = given_by_rest(p, t);
  p->plan->works_at_rest = !ir_is_number(g, given, 0);
  if (p->plan->works_at_rest) want(p->plan, a, given, TO_GIVEN_BY_REST, 0);
}

static void plan_observe(planner *p, const seen_law *t, segment *a) {
  want(p->plan, a, t->stored, TO_OBSERVED, 0);
  for (int k = 0; k < p->plan->law->outputs.count; k++)
    want(p->plan, a, t->outputs[k], TO_OBSERVED, 1 + k);
}

/* The step law of a bond that is not protected, and not twisted. */
static lowered_law unprotected_step(planner *p) {
  ir *g = p->plan->graph;
  const law *l = p->plan->law;
  lowered_law bare = p->step;
  bare.fields = copy_nodes(p->plan->memory, p->step.fields, l->fields.count);
  const ir_node zero = ir_constant(g, 0), to[] = {zero, zero};
  ir_node from[] = {kinematics_input(g, ENDS_PROTECTED), IR_NONE};
  if (l->twists) from[1] = lower_quantity(g, QUANTITY_TWIST);
  substitute_law(g, l, &bare, from, to, l->twists ? 2 : 1);
  return bare;
}

static void plan_states(planner *p, const lowered_law *bare) {
  segment *a = plan_single(p->plan, PROGRAM_STATES, "states", OVER_BONDS);
  ir_node results[PL_STATE_RESULTS] = {bare->N, bare->M_i[0], bare->M_j[0]};
  for (int k = 0; k < PL_STATE_RESULTS; k++)
    want(p->plan, a, results[k] == IR_NONE ? ir_constant(p->plan->graph, 0) : results[k], TO_OUT,
         k);
  for (int k = 0; k < p->plan->law->fields.count; k++)
    want(p->plan, a, bare->fields[k], TO_OUT, PL_STATE_RESULTS + k);
}

/* d(result)/d(stretch): the present length follows the stretch, L = s (1 + stretch). */
static ir_node slope(ir *g, ir_node result, builtin_quantity by) {
  ir_node direct = ir_derivative(g, result, lower_quantity(g, by));
  if (by != QUANTITY_STRETCH) return direct;
  ir_node by_length = ir_derivative(g, result, lower_quantity(g, QUANTITY_LENGTH));
  return ir_add(g, direct, ir_mul(g, lower_quantity(g, QUANTITY_S), by_length));
}

static void plan_tangent(planner *p, const lowered_law *bare) {
  ir *g = p->plan->graph;
  segment *a = plan_single(p->plan, PROGRAM_TANGENT, "tangent", OVER_BONDS);
  ir_node results[PL_STATE_RESULTS] = {bare->N, bare->M_i[0], bare->M_j[0]};
  for (int k = 0; k < PL_STATE_RESULTS; k++)
    for (int q = 0; q < PL_STATE_RATES; q++) {
      ir_node d = results[k] == IR_NONE ? ir_constant(g, 0) : slope(g, results[k], law_motion[q]);
      rewrite_zero(g, &d, 1, NULL, 0, &d);
      want(p->plan, a, d, TO_OUT, k * PL_STATE_RATES + q);
    }
}

static bool want_bounds(kernel_plan *p, segment *a, const bounds *in, int k, diagnostics *d) {
  ir_node lower = lower_bound(p->graph, p->law, in->lower, -INFINITY, d);
  ir_node upper = lower_bound(p->graph, p->law, in->upper, INFINITY, d);
  if (lower == IR_NONE || upper == IR_NONE) return false;
  want(p, a, lower, TO_LOWER, k);
  want(p, a, upper, TO_UPPER, k);
  return true;
}

static bool want_defaults(kernel_plan *p, diagnostics *d) {
  const symbol_list *list = &p->law->parameters;
  segment *a = NULL;
  for (int k = 0; k < list->count; k++) {
    if (!list->items[k]->follows) continue;
    if (!a) a = plan_single(p, PROGRAM_DEFAULTS, "defaults", OVER_BODY);
    const ir_node n = lower_bound(p->graph, p->law, list->items[k]->declared->value, NAN, d);
    if (n == IR_NONE) return false;
    want(p, a, n, TO_OUT, k);
  }
  return true;
}

bool plan_bounds(kernel_plan *p, diagnostics *d) {
  const law *l = p->law;
  segment *a = plan_single(p, PROGRAM_BOUNDS, "bounds", OVER_BODY);
  for (int k = 0; k < l->parameters.count; k++)
    if (!want_bounds(p, a, &l->parameters.items[k]->declared->in, k, d)) return false;
  if (!want_defaults(p, d)) return false;
  if (!l->sized) return true;
  a = plan_single(p, PROGRAM_SIZE_BOUNDS, "size_bounds", OVER_BODY);
  return want_bounds(p, a, &l->sized->in, l->parameters.count, d);
}

/* --- the plan --------------------------------------------------------------------------------- */

static bool lower_both(planner *p, diagnostics *d) {
  kernel_plan *plan = p->plan;
  if (!lower_law(plan->law, plan->graph, LOWER_PROTECTABLE, plan->memory, &p->step, d) ||
      !lower_law(plan->law, plan->graph, LOWER_FROZEN, plan->memory, &p->frozen, d))
    return false;
  p->forces = plan_force_fields(plan, &p->step, &p->frozen);
  rest_take_off_law(plan->graph, plan->law, &p->step);
  share_reciprocals(plan->graph, plan->law, &p->step);
  return true;
}

bool plan_strips(kernel_plan *plan, diagnostics *d) {
  planner p = {.plan = plan};
  if (!lower_both(&p, d)) return false;
  static void (*const plan_strip[])(planner *, const seen_law *, segment *) = {
      [PROGRAM_STEP] = plan_step, [PROGRAM_LEDGER] = plan_ledger, [PROGRAM_OBSERVE] = plan_observe};
  const seen_law seen = see_law(&p);
#define X(task, member) plan_strip[task](&p, &seen, plan_single(plan, task, #member, OVER_BONDS));
  STRIP_PROGRAMS(X)
#undef X
  lowered_law bare = unprotected_step(&p);
  plan->stores = plan->law->nonconservative == NULL;
  plan->reads_rates = plan_reads_rates(plan, &bare);
  plan_states(&p, &bare);
  plan_tangent(&p, &bare);
  return true;
}
