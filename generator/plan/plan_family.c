#include "generator/plan/plan_family.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/semantics/law_variant.h"
#include "generator/ir/particle_parts.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/end_rotations.h"
#include "generator/lower/kinematics.h"
#include "generator/lower/lower_energy.h"
#include "generator/lower/lower_inputs.h"
#include "generator/lower/lower_rest.h"
#include "generator/plan/plan_given.h"
#include "generator/plan/plan_losses.h"
#include "generator/plan/plan_roots.h"

typedef struct family_planner {
  kernel_plan *plan;
  ir *g;
  lowered_law step, frozen;
  ir_node stored; /* J */
} family_planner;

/* Stand for the motion until it is known: components of the present direction; 1/length and chord,
   of which it is the product (where forces act along reference directions: of the reference
   bond); what end_rotations.h has of a bond in space; how quickly the ends of one in the plane turn
   against it. */
enum {
  DIRECTION,
  PER_LENGTH = 3,
  CHORD,
  BENT = 7,
  ALONG = 11,
  TURN,
  TURNING = TURN + 3,
  PRESENT_COUNT = TURNING + 2
};

static ir_node present(ir *g, int which) {
  return ir_input(g, IR_FROM_QUANTITY, QUANTITY_COUNT + 2 * BENDING_AXES + which, "e", ON_BOND);
}

static ir_node family_sum(ir *g, ir_node n) {
  return ir_make(g, IR_FAMILY_SUM, n, IR_NONE, IR_NONE);
}

/* --- results ---------------------------------------------------------------------------------- */

/* The mean of the forces of both sides, by what either particle gives. Fields on bonds are the same
   seen from both ends. */
static ir_node in_parts(const kernel_plan *plan, const lowered_law *of) {
  const law *l = plan->law;
  ir_node *same = must_alloc(((size_t)l->fields.count + 1) * sizeof *same);
  int count = 0;
  for (int k = 0; k < l->fields.count; k++)
    if (l->fields.items[k]->place == ON_BOND) same[count++] = of->fields[k];
  const ir_node half = ir_mul(plan->graph, ir_constant(plan->graph, 0.5), of->F);
  const ir_node sum = particle_parts_of_both(plan->graph, half, same, count);
  free(same);
  return sum;
}

/* Force on the particle along the bond: the mean of what both sides say. A law of bonds says the
   same on both. */
static ir_node bond_force(const kernel_plan *plan, const lowered_law *of) {
  ir *g = plan->graph;
  ir_node f = of->N;
  if (plan->law->tree->law == LAW_STATE) {
    ir_node other = ir_make(g, IR_NEIGHBOUR, of->F, IR_NONE, IR_NONE);
    f = plan->form == FORM_LOOPS ? ir_scaled(g, 0.5, ir_add(g, of->F, other)) : in_parts(plan, of);
  }
  ir_set_name(g, f, "bond_force", (span){0, 0, 0});
  return f;
}

/* What the bond does, in terms of stand-ins. */
static bond_actions actions_of(const kernel_plan *plan, const lowered_law *of) {
  ir *g = plan->graph;
  ir_node e[3] = {IR_NONE, IR_NONE, IR_NONE};
  end_rotations r;
  for (int d = 0; d < plan->dimensions; d++)
    e[d] = present(g, DIRECTION + d);
  const ir_node per_length = present(g, PER_LENGTH);
  if (plan->dimensions == 2) return end_actions_in_plane(g, of, e, per_length);
  for (int k = 0; k < BENDING_AXES; k++) {
    r.theta_i[k] = lower_bending(g, plan->law, QUANTITY_THETA_I, k);
    r.theta_j[k] = lower_bending(g, plan->law, QUANTITY_THETA_J, k);
    r.turn[k] = present(g, TURN + k);
  }
  for (int end = 0; end < 2; end++) {
    r.h[end] = present(g, BENT + end);
    r.k[end] = present(g, BENT + 2 + end);
  }
  r.along = present(g, ALONG);
  return end_actions_in_space(g, of, e, per_length, &r);
}

void plan_want(const kernel_plan *plan, segment *wanted, ir_node node, segment_target target,
               segment_kind over, int index) {
  segment_add(plan->memory, wanted,
              (segment_root){.node = node, .target = target, .over = over, .index = index});
}

/* Particles receive the opposite of the moments on the bond's ends. */
static void plan_forces_and_moments(const kernel_plan *plan, const lowered_law *of,
                                    segment *wanted) {
  ir *g = plan->graph;
  const bond_actions a = actions_of(plan, of);
  for (int d = 0; d < plan->dimensions; d++)
    plan_want(plan, wanted, family_sum(g, a.force[d]), TO_FORCE, OVER_PARTICLES, d);
  for (int k = 0; k < plan->rotations; k++) {
    const ir_node sum = family_sum(g, a.moment[k]);
    plan_want(plan, wanted, ir_neg(g, sum), TO_FORCE, OVER_PARTICLES, plan->dimensions + k);
  }
}

/* Of a vector toward each neighbour: half the difference of both sides. */
static void plan_vector_forces(const kernel_plan *plan, const lowered_law *of, segment *wanted) {
  ir *g = plan->graph;
  static const char *const names[FORCE_AXES] = {"bond_force_x", "bond_force_y", "bond_force_z"};
  for (int d = 0; d < plan->dimensions; d++) {
    const ir_node other = ir_unary(g, IR_NEIGHBOUR, of->F_of[d]);
    const ir_node f = ir_scaled(g, 0.5, ir_sub(g, of->F_of[d], other));
    ir_set_name(g, f, names[d], (span){0, 0, 0});
    plan_want(plan, wanted, family_sum(g, f), TO_FORCE, OVER_PARTICLES, d);
  }
}

void plan_forces(const kernel_plan *plan, const lowered_law *of, segment *wanted) {
  ir *g = plan->graph;
  if (lowered_is_vector(of)) {
    plan_vector_forces(plan, of, wanted);
    return;
  }
  if (plan->rotations) {
    plan_forces_and_moments(plan, of, wanted);
    return;
  }
  ir_node f = bond_force(plan, of);
  const bool pairs = plan->form == FORM_PAIRS;
  if (pairs) f = ir_mul(g, f, present(g, PER_LENGTH));
  for (int d = 0; d < plan->dimensions; d++) {
    const ir_node along = present(g, (pairs ? CHORD : DIRECTION) + d);
    plan_want(plan, wanted, family_sum(g, ir_mul(g, f, along)), TO_FORCE, OVER_PARTICLES, d);
  }
}

/* The particle's share of what its bonds store, J. Without `energy W` half of force times stretch
   of forces that are homogeneous of degree one, else IR_NONE. */
static ir_node stored_energy(family_planner *p) {
  const law *l = p->plan->law;
  ir *g = p->g;
  ir_node rate = lower_quantity(g, QUANTITY_STRETCH_RATE);
  ir_node stretch = lower_quantity(g, QUANTITY_STRETCH), s = lower_quantity(g, QUANTITY_S);
  if (l->tree->law != LAW_STATE)
    return ir_scaled(g, 0.5, family_sum(g, lower_stored_energy(g, l, &p->frozen)));
  ir_node F, W = p->frozen.W;
  if (W != IR_NONE) {
    rewrite_zero(g, &W, 1, &rate, 1, &W);
    return W;
  }
  if (lowered_is_vector(&p->frozen)) return IR_NONE;
  rewrite_zero(g, &p->frozen.F, 1, &rate, 1, &F);
  ir_node length = lower_quantity(g, QUANTITY_LENGTH); /* s (1 + stretch) is not homogeneous */
  if (rewrite_depends(g, &F, 1, &length, 1) || rewrite_degree(g, F, &stretch, 1) != 1)
    return IR_NONE;
  ir_node work = ir_mul(g, ir_mul(g, F, stretch), s);
  return ir_scaled(g, 0.25, family_sum(g, work));
}

/* --- roots ------------------------------------------------------------------------------------ */

static segment step_roots(family_planner *p) {
  const kernel_plan *plan = p->plan;
  segment r = {.root_count = 0};
  for (int k = 0; k < plan->law->fields.count; k++)
    plan_want(plan, &r, p->step.fields[k], TO_FIELD,
              segment_kind_at(plan->law->fields.items[k]->place), k);
  plan_forces(plan, &p->step, &r);
  return r;
}

static segment observe_roots(family_planner *p) {
  kernel_plan *plan = p->plan;
  const symbol_list *outputs = &plan->law->outputs;
  segment r = {.root_count = 0};
  const ir_node stored = p->stored;
  plan->stores = stored != IR_NONE && plan->law->nonconservative == NULL;
  plan_want(plan, &r, stored != IR_NONE ? stored : ir_constant(p->g, 0), TO_OBSERVED,
            OVER_PARTICLES, 0);
  for (int k = 0; k < outputs->count; k++)
    plan_want(plan, &r, p->frozen.outputs[k], TO_OBSERVED,
              segment_kind_at(outputs->items[k]->place), 1 + k);
  return r;
}

/* What is stored and the forces, with a stand-in for the rest stretch. */
static void hold_rest(const family_planner *p, law_energy *of, lowered_law *held) {
  ir_node *force[LOWERED_FORCES];
  *held = p->frozen;
  for (int k = lowered_forces(held, force) - 1; k >= 0; k--)
    rest_hold(p->g, p->plan->law, &p->frozen, force[k]);
  rest_hold(p->g, p->plan->law, &p->frozen, &of->stored);
  of->frozen = held;
}

static ir_node given_by_rest(const family_planner *p, const law_energy *of,
                             const ir_node *new_fields) {
  const bool rests = p->frozen.rest != IR_NONE;
  const ir_node stand_in = rests ? rest_stand_in(p->g, p->plan->law) : IR_NONE;
  return plan_given_by_rest(p->plan, &(rest_energy){.stored = of->stored,
                                                    .power = plan_still_power(p->plan, of),
                                                    .stand_in = &stand_in,
                                                    .rest = &p->frozen.rest,
                                                    .rests = rests,
                                                    .new_fields = new_fields,
                                                    .forces = of->forces});
}

/* What is lost in the step with these roots, and given; empty where nothing can be, or it is not
   known. */
static segment loss_roots(family_planner *p, law_energy of, const segment *step) {
  kernel_plan *plan = p->plan;
  const int fields = plan->law->fields.count;
  const bool rest_moves = plan_rest_changes(plan, &p->frozen.rest, p->frozen.rest != IR_NONE),
             loses = fields > 0 || plan->reads_rates || rest_moves;
  ir_node lost[PL_LOSSES], *new_fields = must_alloc(((size_t)fields + 1) * sizeof *new_fields);
  lowered_law held;
  segment r = {.root_count = 0};
  for (int k = 0; k < fields; k++)
    new_fields[k] = step->roots[k].node;
  hold_rest(p, &of, &held);
  if (plan->stores && loses && plan_losses(plan, &of, new_fields, lost)) {
    lost[PL_GIVEN_BY_REST] = rest_moves ? given_by_rest(p, &of, new_fields) : ir_constant(p->g, 0);
    plan->works_at_rest = !ir_is_number(p->g, lost[PL_GIVEN_BY_REST], 0);
    for (int k = 0; k < PL_LOSSES - !plan->works_at_rest; k++)
      plan_want(plan, &r, rest_filled_in(p->g, plan->law, p->frozen.rest, lost[k]),
                TO_DISSIPATED_STATE + k, OVER_PARTICLES, k);
  }
  free(new_fields);
  return r;
}

/* --- motion ----------------------------------------------------------------------------------- */

enum { MOST_MOTION = 5 + PRESENT_COUNT + 2 * BENDING_AXES };

static int motion_in_plane(ir *g, const family_kinematics *k, ir_node *from, ir_node *to) {
  from[0] = lower_quantity(g, QUANTITY_THETA_I), to[0] = k->theta_i;
  from[1] = lower_quantity(g, QUANTITY_THETA_J), to[1] = k->theta_j;
  for (int end = 0; end < 2; end++)
    from[2 + end] = present(g, TURNING + end), to[2 + end] = k->theta_rate[end];
  return 4;
}

static int motion_in_space(const kernel_plan *plan, const family_kinematics *k, ir_node *from,
                           ir_node *to) {
  ir *g = plan->graph;
  moving_chord c = {.per_length = k->per_length};
  int n = 0;
  for (int d = 0; d < 3; d++) {
    c.reference[d] = k->reference[d];
    c.d[d] = k->d[d];
    c.chord[d] = k->chord[d];
    c.e[d] = k->now[d];
  }
  const end_rotations r = end_rotations_in_space(g, &c, plan->form == FORM_PAIRS);
  for (int axis = 0; axis < BENDING_AXES; axis++) {
    from[n] = lower_bending(g, plan->law, QUANTITY_THETA_I, axis), to[n++] = r.theta_i[axis];
    from[n] = lower_bending(g, plan->law, QUANTITY_THETA_J, axis), to[n++] = r.theta_j[axis];
    from[n] = present(g, TURN + axis), to[n++] = r.turn[axis];
  }
  for (int end = 0; end < 2; end++) {
    from[n] = present(g, BENT + end), to[n++] = r.h[end];
    from[n] = present(g, BENT + 2 + end), to[n++] = r.k[end];
  }
  from[n] = present(g, ALONG), to[n++] = r.along;
  from[n] = lower_quantity(g, QUANTITY_TWIST), to[n++] = r.twist;
  return n;
}

program_motion plan_motion(const kernel_plan *plan, bool reference) {
  ir *g = plan->graph;
  const bool in_plane = plan->rotations && plan->dimensions == 2;
  family_kinematics k = kinematics_family(g, plan->dimensions, in_plane, plan->form == FORM_PAIRS,
                                          plan->law->irregular);
  ir_node *from = arena_alloc(plan->memory, MOST_MOTION * sizeof *from);
  ir_node *to = arena_alloc(plan->memory, MOST_MOTION * sizeof *to);
  int n = 0;
  from[n] = lower_quantity(g, QUANTITY_STRETCH), to[n++] = k.stretch;
  from[n] = lower_quantity(g, QUANTITY_STRETCH_RATE), to[n++] = k.stretch_rate;
  from[n] = lower_quantity(g, QUANTITY_LENGTH), to[n++] = k.length;
  from[n] = lower_quantity(g, QUANTITY_DT), to[n++] = kinematics_advance(g, ON_PARTICLE);
  from[n] = present(g, PER_LENGTH);
  const ir_node s = lower_quantity(g, QUANTITY_S);
  to[n++] = reference ? ir_div(g, ir_constant(g, 1), s) : k.per_length;
  for (int d = 0; d < plan->dimensions; d++) {
    from[n] = present(g, DIRECTION + d);
    to[n++] = reference ? k.reference[d] : k.now[d];
    from[n] = present(g, CHORD + d);
    to[n++] = reference ? k.reference_chord[d] : k.chord[d];
  }
  if (plan->rotations)
    n += in_plane ? motion_in_plane(g, &k, from + n, to + n)
                  : motion_in_space(plan, &k, from + n, to + n);
  return (program_motion){from, to, n};
}

/* --- what a row knows for a whole direction --------------------------------------------------- */

enum { MASS_INPUTS = 3, LIST_INPUTS = 6 + MASS_INPUTS };

static int mass_inputs(ir *g, ir_node *from, ir_node *to) {
  const ir_node mine = kinematics_input(g, ENDS_MASS_I), other = kinematics_input(g, ENDS_MASS_J);
  from[0] = lower_quantity(g, QUANTITY_M_END_I), to[0] = mine;
  from[1] = lower_quantity(g, QUANTITY_M_END_J), to[1] = other;
  from[2] = lower_quantity(g, QUANTITY_M_BOND), to[2] = ir_make(g, IR_MIN, mine, other, IR_NONE);
  return MASS_INPUTS;
}

/* A list knows for each bond. */
static program_motion list_inputs(const kernel_plan *plan) {
  static const ends_input row_chord[] = {ENDS_CLASS_CHORD_X, ENDS_CLASS_CHORD_Y,
                                         ENDS_CLASS_CHORD_Z},
                          chord[] = {ENDS_CHORD_X, ENDS_CHORD_Y, ENDS_CHORD_Z};
  ir *g = plan->graph;
  ir_node *from = arena_alloc(plan->memory, LIST_INPUTS * sizeof *from);
  ir_node *to = arena_alloc(plan->memory, LIST_INPUTS * sizeof *to);
  int n = 0;
  for (int d = 0; d < 3; d++)
    from[n] = kinematics_input(g, row_chord[d]), to[n++] = kinematics_input(g, chord[d]);
  from[n] = lower_quantity(g, QUANTITY_S), to[n++] = kinematics_input(g, ENDS_REFERENCE_LENGTH);
  n += mass_inputs(g, from + n, to + n);
  from[n] = lower_quantity(g, QUANTITY_SHELL), to[n++] = ir_constant(g, 1);
  from[n] = lower_quantity(g, QUANTITY_WEIGHT), to[n++] = ir_constant(g, 1);
  return (program_motion){from, to, n};
}

/* Particles of different densities know for each its mass. */
static program_motion masses(const kernel_plan *plan) {
  ir_node *from = arena_alloc(plan->memory, MASS_INPUTS * sizeof *from);
  ir_node *to = arena_alloc(plan->memory, MASS_INPUTS * sizeof *to);
  return (program_motion){from, to, mass_inputs(plan->graph, from, to)};
}

static void read_of_each(const kernel_plan *plan, const program_motion *of, segment *r) {
  ir_substitution *s = ir_substitution_new(plan->graph);
  for (int k = 0; k < of->count; k++)
    ir_substitution_add(s, of->from[k], of->to[k]);
  for (int k = 0; k < r->root_count; k++)
    if (r->roots[k].node != IR_NONE) r->roots[k].node = ir_substitution_apply(s, r->roots[k].node);
  ir_substitution_free(s);
}

static void motion_of_each(const kernel_plan *plan, const program_motion *of,
                           program_motion *motion) {
  ir_node *to = arena_alloc(plan->memory, MOST_MOTION * sizeof *to);
  ir_substitute(plan->graph, motion->to, motion->count, of->from, of->to, of->count, to);
  motion->to = to;
}

/* --- the plan --------------------------------------------------------------------------------- */

/* The same reciprocals in all that a step computes. */
static void share_reciprocals(family_planner *p) {
  const int fields = p->plan->law->fields.count;
  ir_node *force[LOWERED_FORCES];
  const int count = lowered_forces(&p->step, force);
  ir_node *all = must_alloc(((size_t)fields + LOWERED_FORCES) * sizeof *all);
  for (int k = 0; k < count; k++)
    all[k] = *force[k];
  memcpy(all + count, p->step.fields, (size_t)fields * sizeof *all);
  rewrite_reciprocals(p->g, all, count + fields, all);
  for (int k = 0; k < count; k++)
    *force[k] = all[k];
  memcpy(p->step.fields, all + count, (size_t)fields * sizeof *all);
  free(all);
}

static void share_reciprocals_of_roots(ir *g, segment *r) {
  ir_node *all = segment_values(r);
  rewrite_reciprocals(g, all, r->root_count, all);
  segment_replace(r, all);
  free(all);
}

/* Of what both ends of a bond in space see alike fused products would tell nothing: where one end
   computes it, they are fused later. */
static bool fuses_late(const kernel_plan *plan) {
  return plan->rotations == 3 && plan->form == FORM_PAIRS;
}

/* All at once: what several passes compute they compute in the same way. */
static void rewrite_last(const kernel_plan *plan, segment *const *of, int segments) {
  ir *g = plan->graph;
  int count = 0, at = 0;
  for (int n = 0; n < segments; n++)
    count += of[n]->root_count;
  ir_node *all = must_alloc(((size_t)count + 1) * sizeof *all);
  for (int n = 0; n < segments; n++)
    for (int k = 0; k < of[n]->root_count; k++)
      all[at++] = of[n]->roots[k].node;
  rewrite_choices(g, all, count, all);
  rewrite_factors(g, all, count, all);
  if (!fuses_late(plan)) rewrite_fused(g, all, count, all);
  for (int n = 0, from = 0; n < segments; from += of[n++]->root_count)
    segment_replace(of[n], all + from);
  free(all);
}

static void fuse_motion(const kernel_plan *plan, program_motion *motion) {
  if (fuses_late(plan)) return;
  ir_node *to = arena_alloc(plan->memory, MOST_MOTION * sizeof *to);
  rewrite_fused(plan->graph, motion->to, motion->count, to);
  motion->to = to;
}

/* A component toward the neighbour. It has a name, and so a line: clang does not vectorise choices
   between long expressions. */
static void want_component(const kernel_plan *plan, segment *wanted, ir_node node, int index) {
  static const char *const names[] = {"T_x", "T_y", "T_z", "M_x", "M_y", "M_z"};
  const bool about_z = plan->dimensions == 2 && index == 2;
  ir_set_name(plan->graph, node, about_z ? "M_z" : names[index], (span){0, 0, 0});
  plan_want(plan, wanted, node, TO_FORCE, OVER_NEIGHBOURS, index);
}

/* What the particle's own side of a bond does to it: half of the force that it says, since the bond
   carries the mean of both sides; of moments its own end's. */
static segment force_state_roots(const kernel_plan *plan, const lowered_law *of) {
  ir *g = plan->graph;
  bond_actions a = {.moment = {IR_NONE}};
  segment r = {.root_count = 0};
  if (plan->rotations) a = actions_of(plan, of);
  for (int d = 0; d < plan->dimensions; d++) {
    const ir_node along = plan->law->tree->law == LAW_STATE ? of->F : of->N;
    if (lowered_is_vector(of))
      a.force[d] = of->F_of[d];
    else if (!plan->rotations)
      a.force[d] = ir_mul(g, along, present(g, DIRECTION + d));
    const ir_node own = ir_mul(g, ir_constant(g, 0.5), a.force[d]);
    want_component(plan, &r, own, d);
  }
  for (int k = 0; k < plan->rotations; k++)
    want_component(plan, &r, ir_neg(g, a.moment[k]), plan->dimensions + k);
  return r;
}

/* Behind the new fields of the step. */
static segment alone_roots(family_planner *p, const segment *step) {
  const kernel_plan *plan = p->plan;
  segment r = {.root_count = 0}, forces;
  if (!plan->variation.alone) return r;
  forces = force_state_roots(plan, &p->step);
  rewrite_last(plan, (segment *[]){&forces}, 1);
  for (int k = 0; k < plan->law->fields.count; k++)
    segment_add(plan->memory, &r, step->roots[k]);
  for (int k = 0; k < forces.root_count; k++)
    segment_add(plan->memory, &r, forces.roots[k]);
  return r;
}

typedef struct input_search {
  const kernel_plan *plan;
  bool (*wanted)(const ir *g, ir_node input);
  bool found;
} input_search;

static void look_for_input(void *context, const segment *a) {
  input_search *c = context;
  const ir *g = c->plan->graph;
  unsigned char *needed = segment_needed(g, a);
  for (ir_node n = 0; n < ir_count(g) && !c->found; n++)
    c->found = needed[n] && ir_operation(g, n) == IR_INPUT && c->wanted(g, n);
  free(needed);
}

static bool reads(const kernel_plan *plan, bool (*wanted)(const ir *g, ir_node input)) {
  input_search c = {.plan = plan, .wanted = wanted};
  plan_visit(plan, look_for_input, &c);
  return c.found;
}

static bool program_reads(const kernel_plan *plan, const kernel_program *q,
                          bool (*wanted)(const ir *g, ir_node input)) {
  input_search c = {.plan = plan, .wanted = wanted};
  plan_visit_program(q, look_for_input, &c);
  return c.found;
}

static bool is_shape(const ir *g, ir_node input) {
  return ir_input_source(g, input) == IR_FROM_SHAPE;
}

static bool is_share(const ir *g, ir_node input) {
  return ir_input_source(g, input) == IR_FROM_ENDS &&
         ends_origins[ir_input_index(g, input)].array == FROM_SHARE;
}

static bool is_mass(const ir *g, ir_node input) {
  return ir_input_source(g, input) == IR_FROM_ENDS &&
         ends_origins[ir_input_index(g, input)].array == FROM_MASS;
}

/* Whether ends of bonds share what is the same for both: on lattices, where reading what the other
   end has left is cheap. Laws that keep fields on bonds in space have families of a long horizon
   (lps: 122): what their bonds share would fill no cache, and where nothing is known of the lattice
   they compute it on either side (a sixth faster; with 18 neighbours sharing is 1.4 times as
   fast). */
static program_sharing sharing(const family_planner *p) {
  const law *l = p->plan->law;
  bool on_bonds = false;
  for (int k = 0; k < l->fields.count; k++)
    on_bonds = on_bonds || l->fields.items[k]->place > ON_PARTICLE;
  if (p->plan->form == FORM_PAIRS) return SHARE_PAIRS;
  if (p->plan->form == FORM_UNROLLED) return p->plan->dimensions == 2 ? SHARE_MOST : SHARE_MORE;
  return !l->irregular && (p->plan->dimensions == 2 || !on_bonds) ? SHARE_DEAR : SHARE_NOTHING;
}

static bool is_of_neighbours_fields(const ir *g, ir_node input) {
  return ir_input_source(g, input) == IR_FROM_NEIGHBOUR_FIELD;
}

/* It computes new fields once more: seldom, where a pass can tell that none have changed. */
static void build_losses(family_planner *p, const segment *r, const program_motion *motion) {
  kernel_plan *plan = p->plan;
  kernel_program *losses = &plan->programs[PROGRAM_LEDGER];
  program_build(losses, "losses", p->g, plan->memory, r, motion, SHARE_NOTHING, &plan->links);
  plan->loses_by_own_fields = losses->pass_count == 1 && !plan->works_at_rest &&
                              ir_is_number(p->g, r->roots[PL_LOST_TO_RATES].node, 0) &&
                              !program_reads(plan, losses, is_of_neighbours_fields);
}

static bool reads_thickness(const family_planner *p) {
  const law *l = p->plan->law;
  ir_node t = lower_quantity(p->g, QUANTITY_T), *forces[LOWERED_FORCES];
  lowered_law step = p->step;
  const int count = lowered_forces(&step, forces);
  if (p->frozen.W != IR_NONE && rewrite_depends(p->g, &p->frozen.W, 1, &t, 1)) return true;
  for (int k = 0; k < count; k++)
    if (rewrite_depends(p->g, forces[k], 1, &t, 1)) return true;
  return rewrite_depends(p->g, p->step.fields, l->fields.count, &t, 1);
}

static void take_off_roots(const family_planner *p, const lowered_law *of, segment *a) {
  for (int k = 0; k < a->root_count; k++)
    rest_take_off(p->g, of, &a->roots[k].node, 1);
}

void plan_axes(kernel_plan *plan) {
  const bool turns = law_kind_turns(plan->law->tree->law);
  plan->dimensions = lower_dimensions(plan->law);
  plan->rotations = !turns ? 0 : plan->dimensions == 2 ? 1 : 3;
  plan->dof = plan->dimensions + plan->rotations;
  if (plan->rotations == 3) plan->law = law_bending_in_space(plan->law);
}

static bool has_few_passes(const kernel_plan *plan) {
  bool few = true;
  for (int task = PROGRAM_STEP; task <= PROGRAM_FORCE_STATE; task++)
    few = few && plan->programs[task].pass_count <= PLAN_MOST_PASSES;
  return few;
}

bool plan_programs(kernel_plan *plan, diagnostics *d) {
  family_planner p = {.plan = plan, .g = plan->graph};
  plan_axes(plan);
  const law *l = plan->law;
  const law_variation *v = &plan->variation;
  if (!lower_law_varying(l, p.g, LOWER_HELD, v, plan->memory, &p.step, d) ||
      !lower_law_varying(l, p.g, LOWER_FROZEN, v, plan->memory, &p.frozen, d))
    return false;
  if (plan->dimensions == 3 && reads_thickness(&p)) {
    diag_report(d, DIAG_CONFLICT, l->tree->name_where,
                "this law reads the thickness `t`, which a lattice in space does not have");
    diag_hint(d, "say `for plane_stress` after `law state`, or give another value `when space`");
    return false;
  }
  p.stored = stored_energy(&p);
  law_energy energy = {.frozen = &p.frozen,
                       .stored = p.stored,
                       .theta_rate = {IR_NONE, IR_NONE},
                       .forces = plan_force_fields(plan, &p.step, &p.frozen)};
  for (int end = 0; end < 2 && plan->rotations && plan->dimensions == 2; end++)
    energy.theta_rate[end] = present(p.g, TURNING + end);
  share_reciprocals(&p);
  segment step = step_roots(&p), observe = observe_roots(&p);
  plan->reads_rates = plan_reads_rates(plan, &p.step);
  share_reciprocals_of_roots(p.g, &observe);
  rewrite_last(plan, (segment *[]){&step, &observe}, 2);
  segment alone = alone_roots(&p, &step);
  take_off_roots(&p, &p.step, &step);
  take_off_roots(&p, &p.step, &alone);
  take_off_roots(&p, &p.frozen, &observe);
  segment losses = loss_roots(&p, energy, &step);
  program_motion motion = plan_motion(plan, p.step.along_reference);
  fuse_motion(plan, &motion);
  if (l->irregular || v->masses) {
    const program_motion each = l->irregular ? list_inputs(plan) : masses(plan);
    read_of_each(plan, &each, &step);
    read_of_each(plan, &each, &observe);
    read_of_each(plan, &each, &losses);
    read_of_each(plan, &each, &alone);
    motion_of_each(plan, &each, &motion);
  }
  kernel_program *programs = plan->programs;
  program_build(&programs[PROGRAM_STEP], "step", p.g, plan->memory, &step, &motion, sharing(&p),
                &plan->links);
  if (losses.root_count) build_losses(&p, &losses, &motion);
  program_build(&programs[PROGRAM_OBSERVE], "observe", p.g, plan->memory, &observe, &motion,
                SHARE_NOTHING, &plan->links);
  if (alone.root_count)
    program_build(&programs[PROGRAM_FORCE_STATE], "force_state", p.g, plan->memory, &alone, &motion,
                  SHARE_LEAST, &plan->links);
  if (!has_few_passes(plan)) {
    diag_report(d, DIAG_NOT_SUPPORTED, l->tree->law_where,
                "values of neighbours of neighbours are needed more than %d deep in one step",
                PLAN_MOST_PASSES);
    return false;
  }
  plan->reads_shape = reads(plan, is_shape);
  plan->reads_share = reads(plan, is_share);
  plan->reads_mass = reads(plan, is_mass);
  return true;
}
