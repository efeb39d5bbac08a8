#include "generator/plan/plan_given.h"

#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/kinematics.h"
#include "generator/lower/lower_inputs.h"
#include "generator/lower/lower_rest.h"

/* --- the same with something else ------------------------------------------------------------- */

static ir_node with_rest(const kernel_plan *plan, const rest_energy *of, const ir_node *rest,
                         ir_node n) {
  if (n == IR_NONE || of->rests == 0) return n;
  ir_substitute(plan->graph, &n, 1, of->stand_in, rest, of->rests, &n);
  return n;
}

static void with_new_fields(const kernel_plan *plan, const rest_energy *of, const ir_node *nodes,
                            int count, ir_node *out) {
  const int fields = plan->law->fields.count;
  ir_node *at_hand = must_alloc(((size_t)fields + 1) * sizeof *at_hand);
  for (int k = 0; k < fields; k++)
    at_hand[k] = lower_field(plan->graph, plan->law, k);
  ir_substitute(plan->graph, nodes, count, at_hand, of->new_fields, fields, out);
  free(at_hand);
}

/* Of fields that change in time what they were a step ago. */
static ir_node a_step_ago(const kernel_plan *plan, ir_node n) {
  const law_variation *v = &plan->variation;
  const int own = v->varying_count - v->before_count;
  ir_node *now = must_alloc((2 * (size_t)v->before_count + 1) * sizeof *now),
          *before = now + v->before_count;
  for (int k = 0; k < v->before_count; k++) {
    int at = 0;
    while (v->varying[at] != v->varying[own + k])
      at++;
    now[k] = lower_varying(plan->graph, plan->law, v, at);
    before[k] = lower_varying(plan->graph, plan->law, v, own + k);
  }
  if (n != IR_NONE) ir_substitute(plan->graph, &n, 1, now, before, v->before_count, &n);
  free(now);
  return n;
}

/* --- what is given ---------------------------------------------------------------------------- */

/* `part` of the step's way with the change of the power. */
static ir_node between(const kernel_plan *plan, ir_node stored, ir_node stored_before,
                       ir_node power, ir_node power_before, double part) {
  ir *g = plan->graph;
  if (stored == stored_before) return ir_constant(g, 0);
  const ir_node given = ir_sub(g, stored, stored_before);
  if (power == power_before || part == 0) return given;
  const ir_node way = ir_scaled(g, part, kinematics_input(g, ENDS_TIME_STEP));
  return ir_add(g, given, ir_mul(g, way, ir_sub(g, power, power_before)));
}

static ir_node given_by_fields(const kernel_plan *plan, const rest_energy *of) {
  const ir_node stored = with_rest(plan, of, of->rest, of->stored),
                power = with_rest(plan, of, of->rest, of->power);
  const ir_node stored_before = a_step_ago(plan, stored);
  return between(plan, stored, stored_before, power, a_step_ago(plan, power), -0.5);
}

static ir_node given_by_states(const kernel_plan *plan, const rest_energy *of) {
  static const double parts[] = {
      [FORCES_OF_BOTH] = 0, [FORCES_OF_NEW] = -0.5, [FORCES_OF_OLD] = 0.5};
  ir *g = plan->graph;
  ir_node *rest = must_alloc(((size_t)of->rests + 1) * sizeof *rest), stored, power = of->power;
  with_new_fields(plan, of, of->rest, of->rests, rest);
  with_new_fields(plan, of, &of->stored, 1, &stored);
  if (power != IR_NONE) with_new_fields(plan, of, &power, 1, &power);
  ir_node given = ir_constant(g, 0);
  if (of->rests > 0) {
    const ir_node there = with_rest(plan, of, rest, stored),
                  here = with_rest(plan, of, of->rest, stored),
                  power_there = with_rest(plan, of, rest, power);
    given = between(plan, there, here, power_there, with_rest(plan, of, of->rest, power),
                    parts[of->forces]);
  }
  free(rest);
  return given;
}

ir_node plan_given_by_rest(const kernel_plan *plan, const rest_energy *of) {
  ir *g = plan->graph;
  if (of->stored == IR_NONE) return ir_constant(g, 0);
  const ir_node by_fields = given_by_fields(plan, of);
  return ir_add(g, by_fields, given_by_states(plan, of));
}

bool plan_rest_changes(const kernel_plan *plan, const ir_node *rest, int rests) {
  return plan->variation.before_count > 0 ||
         rest_reads_states(plan->graph, plan->law, rest, rests);
}
