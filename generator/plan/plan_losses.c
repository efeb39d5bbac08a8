#include "generator/plan/plan_losses.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/lower_energy.h"
#include "generator/lower/lower_inputs.h"

/* --- forces and what they work over ----------------------------------------------------------- */

enum { MOST_PARTS = FORCE_AXES };

typedef struct force_parts { /* of a bond; of laws of families twice what is the particle's half */
  ir_node force[MOST_PARTS], rate[MOST_PARTS];
  int count;
} force_parts;

static void add_part(force_parts *p, ir_node force, ir_node rate) {
  if (force == IR_NONE || rate == IR_NONE) return;
  p->force[p->count] = force;
  p->rate[p->count++] = rate;
}

static const ends_input own_velocity[FORCE_AXES] = {ENDS_V_IX, ENDS_V_IY, ENDS_V_IZ},
                        far_velocity[FORCE_AXES] = {ENDS_V_JX, ENDS_V_JY, ENDS_V_JZ};

static force_parts parts_of(const kernel_plan *plan, const lowered_law *of,
                            const ir_node theta_rate[2]) {
  ir *g = plan->graph;
  force_parts p = {.count = 0};
  const ir_node rate = lower_quantity(g, QUANTITY_STRETCH_RATE);
  for (int d = 0; d < FORCE_AXES && of->F_of[d] != IR_NONE; d++) {
    const ir_node mine = kinematics_input(g, own_velocity[d]);
    add_part(&p, of->F_of[d], ir_sub(g, kinematics_input(g, far_velocity[d]), mine));
  }
  if (lowered_is_vector(of)) return p;
  add_part(&p, plan->law->tree->law == LAW_STATE ? of->F : of->N,
           ir_mul(g, lower_quantity(g, QUANTITY_S), rate));
  add_part(&p, of->M_i[0], theta_rate[0]);
  add_part(&p, of->M_j[0], theta_rate[1]);
  return p;
}

static void at_zero_rate(ir *g, force_parts *p) {
  const ir_node rate = lower_quantity(g, QUANTITY_STRETCH_RATE);
  rewrite_zero(g, p->force, p->count, &rate, 1, p->force);
}

static ir_node *fields_at_hand(const kernel_plan *plan) {
  const int count = plan->law->fields.count;
  ir_node *fields = must_alloc(((size_t)count + 1) * sizeof *fields);
  for (int k = 0; k < count; k++)
    fields[k] = lower_field(plan->graph, plan->law, k);
  return fields;
}

static void with_fields(const kernel_plan *plan, const ir_node *nodes, int count,
                        const ir_node *new_fields, ir_node *out) {
  ir_node *old = fields_at_hand(plan);
  ir_substitute(plan->graph, nodes, count, old, new_fields, plan->law->fields.count, out);
  free(old);
}

force_fields plan_force_fields(const kernel_plan *plan, const lowered_law *step,
                               const lowered_law *frozen) {
  const ir_node known = ir_constant(plan->graph, 1), both[2] = {known, known};
  force_parts used = parts_of(plan, step, both), old = parts_of(plan, frozen, both);
  ir_node new[MOST_PARTS];
  bool is_old = true, is_new = true;
  with_fields(plan, old.force, old.count, step->fields, new);
  for (int k = 0; k < used.count; k++) {
    is_old = is_old && used.force[k] == old.force[k];
    is_new = is_new && used.force[k] == new[k];
  }
  if (step->rest != IR_NONE) {
    with_fields(plan, &frozen->rest, 1, step->fields, new);
    is_old = is_old && step->rest == frozen->rest;
    is_new = is_new && step->rest == new[0];
  }
  return is_new ? FORCES_OF_NEW : is_old ? FORCES_OF_OLD : FORCES_OF_BOTH;
}

/* --- sums ------------------------------------------------------------------------------------- */

typedef struct factors {
  ir_node particle, bond; /* IR_NONE: 1 */
} factors;

static ir_node times(ir *g, ir_node a, ir_node b) {
  return a == IR_NONE ? b : ir_mul(g, a, b);
}

static factors factors_of(ir *g, ir_node n) {
  if (ir_is_of_particle(g, n)) return (factors){n, IR_NONE};
  if (ir_operation(g, n) == IR_DIV && ir_is_of_particle(g, ir_operand(g, n, 1))) {
    factors f = factors_of(g, ir_operand(g, n, 0));
    const ir_node over = f.particle == IR_NONE ? ir_constant(g, 1) : f.particle;
    f.particle = ir_div(g, over, ir_operand(g, n, 1));
    return f;
  }
  if (ir_operation(g, n) != IR_MUL) return (factors){IR_NONE, n};
  factors f = factors_of(g, ir_operand(g, n, 0));
  const factors more = factors_of(g, ir_operand(g, n, 1));
  if (more.particle != IR_NONE) f.particle = times(g, f.particle, more.particle);
  if (more.bond != IR_NONE) f.bond = times(g, f.bond, more.bond);
  return f;
}

/* Over the family. The particle's factors stand outside: both ends of a bond add the same. */
static ir_node family_sum(ir *g, ir_node n) {
  const factors f = factors_of(g, n);
  const ir_node inside = f.bond == IR_NONE ? ir_constant(g, 1) : f.bond;
  const ir_node sum = ir_make(g, IR_FAMILY_SUM, inside, IR_NONE, IR_NONE);
  return f.particle == IR_NONE ? sum : ir_mul(g, f.particle, sum);
}

/* --- differences ------------------------------------------------------------------------------ */

/* a - b of two like expressions, as a difference of what is not alike in them: exactly 0 where that
   is the same, and sums over the family are one sum. */
static ir_node difference(ir *g, ir_node a, ir_node b) {
  const ir_op op = ir_operation(g, a);
  ir_node with[2], of[2];
  if (a == b) return ir_constant(g, 0);
  if (op != ir_operation(g, b)) return ir_sub(g, a, b);
  if (op == IR_FAMILY_SUM) {
    const ir_node inside = difference(g, ir_operand(g, a, 0), ir_operand(g, b, 0));
    return family_sum(g, inside);
  }
  if (op != IR_ADD && op != IR_SUB && op != IR_MUL && op != IR_DIV) return ir_sub(g, a, b);
  for (int k = 0; k < 2; k++)
    with[k] = ir_operand(g, a, k), of[k] = ir_operand(g, b, k);
  if (op == IR_SUB && with[0] == of[0]) return difference(g, of[1], with[1]);
  if (op == IR_ADD || op == IR_SUB) {
    const ir_node first = difference(g, with[0], of[0]), second = difference(g, with[1], of[1]);
    return ir_make(g, op, first, second, IR_NONE);
  }
  if (with[1] == of[1]) return ir_make(g, op, difference(g, with[0], of[0]), with[1], IR_NONE);
  if (op == IR_MUL && with[0] == of[0]) return ir_mul(g, with[0], difference(g, with[1], of[1]));
  return ir_sub(g, a, b);
}

/* --- losses ----------------------------------------------------------------------------------- */

static ir_node over_step(ir *g, ir_node power) {
  const ir_node energy = ir_mul(g, power, kinematics_input(g, ENDS_TIME_STEP));
  return family_sum(g, energy);
}

/* W of a particle's half of the bond; IR_NONE: none. *known is false where it is not all of it. */
static ir_node rate_power(const kernel_plan *plan, const law_energy *of, bool *known) {
  ir *g = plan->graph;
  const ir_node rate = lower_quantity(g, QUANTITY_STRETCH_RATE), half = ir_constant(g, 0.5);
  force_parts whole = parts_of(plan, of->frozen, of->theta_rate), still = whole;
  ir_node power = IR_NONE, *all[LOWERED_FORCES];
  lowered_law frozen = *of->frozen;
  int reading = 0;
  for (int k = lowered_forces(&frozen, all) - 1; k >= 0; k--)
    reading += rewrite_depends(g, all[k], 1, &rate, 1);
  at_zero_rate(g, &still);
  for (int k = 0; k < whole.count; k++) {
    if (!rewrite_depends(g, &whole.force[k], 1, &rate, 1)) continue;
    const ir_node part = ir_mul(g, ir_sub(g, whole.force[k], still.force[k]), whole.rate[k]);
    power = power == IR_NONE ? part : ir_add(g, power, part);
    reading--;
  }
  *known = reading == 0;
  return power == IR_NONE ? IR_NONE : ir_mul(g, half, power);
}

/* W of a particle's half of the bond: of the forces with the old fields less those with the new
   ones. */
static ir_node power_between(ir *g, const force_parts *old, const ir_node *new) {
  ir_node power = ir_constant(g, 0);
  for (int k = 0; k < old->count; k++)
    power = ir_add(g, power, ir_mul(g, difference(g, old->force[k], new[k]), old->rate[k]));
  return ir_mul(g, ir_constant(g, 0.5), power);
}

ir_node plan_still_power(const kernel_plan *plan, const law_energy *of) {
  ir *g = plan->graph;
  force_parts p = parts_of(plan, of->frozen, of->theta_rate);
  ir_node power = ir_constant(g, 0);
  at_zero_rate(g, &p);
  for (int k = 0; k < p.count; k++)
    power = ir_add(g, power, ir_mul(g, p.force[k], p.rate[k]));
  return family_sum(g, ir_mul(g, ir_constant(g, 0.5), power));
}

bool plan_losses(const kernel_plan *plan, const law_energy *of, const ir_node *new_fields,
                 ir_node lost[PL_LOSSES]) {
  ir *g = plan->graph;
  bool known;
  force_parts old = parts_of(plan, of->frozen, of->theta_rate);
  at_zero_rate(g, &old);
  ir_node before[2 + MOST_PARTS] = {of->stored, rate_power(plan, of, &known)},
                     after[2 + MOST_PARTS];
  const int count = 2 + old.count;
  if (!known) return false;
  memcpy(before + 2, old.force, (size_t)old.count * sizeof *before);
  rewrite_reciprocals(g, before, count, before);
  memcpy(old.force, before + 2, (size_t)old.count * sizeof *before);
  with_fields(plan, before, count, new_fields, after);

  lost[PL_LOST_TO_STATES] = difference(g, before[0], after[0]);
  if (of->forces != FORCES_OF_BOTH) {
    const ir_node way = ir_constant(g, of->forces == FORCES_OF_NEW ? -0.5 : 0.5);
    const ir_node missed = ir_mul(g, way, power_between(g, &old, after + 2));
    if (!ir_is_number(g, missed, 0))
      lost[PL_LOST_TO_STATES] = ir_add(g, lost[PL_LOST_TO_STATES], over_step(g, missed));
  }
  lost[PL_LOST_TO_RATES] = after[1] == IR_NONE ? ir_constant(g, 0) : over_step(g, after[1]);
  return true;
}
