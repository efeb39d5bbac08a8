#include "generator/plan/plan_roots.h"

#include <stdlib.h>

#include "generator/ir/operation.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/lower.h"
#include "generator/lower/lower_inputs.h"

segment *plan_single(kernel_plan *p, program_task task, const char *name, segment_kind kind) {
  program_pass *pass = arena_alloc(p->memory, sizeof *pass);
  segment *a = arena_alloc(p->memory, sizeof *a);
  *a = (segment){.kind = kind};
  *pass = (program_pass){.segments = a, .segment_count = 1};
  p->programs[task] = (kernel_program){.name = name, .passes = pass, .pass_count = 1};
  return a;
}

void plan_visit_program(const kernel_program *q, plan_visitor visit, void *context) {
  for (int k = 0; k < q->pass_count; k++)
    for (int s = 0; s < q->passes[k].segment_count; s++)
      visit(context, &q->passes[k].segments[s]);
}

void plan_visit(const kernel_plan *p, plan_visitor visit, void *context) {
  for (int task = 0; task < PROGRAM_BOUNDS; task++)
    plan_visit_program(&p->programs[task], visit, context);
}

bool plan_reads_rates(const kernel_plan *plan, const lowered_law *step) {
  ir_node rate = lower_quantity(plan->graph, QUANTITY_STRETCH_RATE);
  lowered_law of = *step;
  ir_node *forces[LOWERED_FORCES];
  const int count = lowered_forces(&of, forces);
  for (int k = 0; k < count; k++)
    if (rewrite_depends(plan->graph, forces[k], 1, &rate, 1)) return true;
  return rewrite_depends(plan->graph, step->fields, plan->law->fields.count, &rate, 1);
}

/* --- what is hoisted -------------------------------------------------------------------------- */

static void mark_hoisted(const ir *g, ir_node n, unsigned char *hoisted) {
  if (ir_operation(g, n) != IR_CONSTANT && ir_is_uniform(g, n)) hoisted[n] = 1;
}

typedef struct hoisting {
  const ir *graph;
  unsigned char *hoisted;
} hoisting;

static void mark_hoisted_of_roots(void *context, const segment *a) {
  const hoisting *h = context;
  const ir *g = h->graph;
  unsigned char *needed = segment_needed(g, a);
  for (int k = 0; k < a->root_count; k++)
    mark_hoisted(g, a->roots[k].node, h->hoisted);
  for (ir_node n = 0; n < ir_count(g); n++) {
    if (!needed[n] || ir_is_uniform(g, n)) continue;
    for (int k = 0; k < ir_arity(ir_operation(g, n)); k++)
      mark_hoisted(g, ir_operand(g, n, k), h->hoisted);
  }
  free(needed);
}

void plan_hoist(kernel_plan *p) {
  int count = ir_count(p->graph);
  unsigned char *hoisted = must_calloc((size_t)count + 1, 1);
  plan_visit(p, mark_hoisted_of_roots, &(hoisting){p->graph, hoisted});
  for (ir_node n = 0; n < count; n++)
    p->uniform_count += hoisted[n];
  p->uniforms = arena_alloc(p->memory, ((size_t)p->uniform_count + 1) * sizeof *p->uniforms);
  int at = 0;
  for (ir_node n = 0; n < count; n++)
    if (hoisted[n]) p->uniforms[at++] = n;
  free(hoisted);
}

static bool is_time_input(const ir *g, ir_node n) {
  if (ir_operation(g, n) != IR_INPUT || ir_input_source(g, n) != IR_FROM_ENDS) return false;
  return ir_input_index(g, n) == ENDS_TIME_STEP || ir_input_index(g, n) == ENDS_ADVANCE;
}

/* All operands are known before the loop, and some are of time. */
static bool follows_from_time(const ir *g, ir_node n, const unsigned char *uniform,
                              const unsigned char *of_time) {
  const ir_op op = ir_operation(g, n);
  bool some = false;
  if (op == IR_INPUT || op == IR_SEARCH || uniform[n] || ir_is_sought(g, n) ||
      ir_is_expected(g, n))
    return false;
  for (int k = 0; k < ir_arity(op); k++) {
    const ir_node o = ir_operand(g, n, k);
    if (!of_time[o] && !uniform[o] && ir_operation(g, o) != IR_CONSTANT) return false;
    some = some || of_time[o];
  }
  return some;
}

void plan_mark_of_time(const kernel_plan *p, unsigned char *mask) {
  const ir *g = p->graph;
  unsigned char *uniform = must_calloc((size_t)ir_count(g) + 1, 1);
  for (int k = 0; k < p->uniform_count; k++)
    uniform[p->uniforms[k]] = 1;
  for (ir_node n = 0; n < ir_count(g); n++)
    mask[n] = is_time_input(g, n) || follows_from_time(g, n, uniform, mask);
  free(uniform);
}

ir_cost plan_cost(const kernel_plan *p, const segment *a, placement at_least) {
  unsigned char *of_time = must_alloc((size_t)ir_count(p->graph) + 1);
  ir_node *nodes = segment_values(a);
  plan_mark_of_time(p, of_time);
  ir_cost cost = ir_count_cost(p->graph, nodes, segment_value_count(a), at_least, of_time);
  free(nodes);
  free(of_time);
  return cost;
}

/* Of families what is done once for both ends counts half. */
void plan_count_cost(kernel_plan *p) {
  const bool strips = p->form == FORM_STRIPS || p->form == FORM_POINTS || p->form == FORM_TIPS;
  const kernel_program *step = &p->programs[PROGRAM_STEP];
  for (int k = 0; k < step->pass_count; k++)
    for (int s = 0; s < step->passes[k].segment_count; s++) {
      const segment *a = &step->passes[k].segments[s];
      if (a->kind == OVER_PARTICLES) continue;
      const ir_cost cost = plan_cost(p, a, strips ? ON_POINT : ON_BOND);
      const double part = strips || a->kind == OVER_NEIGHBOURS ? 1 : 0.5;
      p->flops_per_bond += part * (cost.additions + cost.multiplications + cost.selects);
      p->divisions_per_bond += part * cost.divisions;
    }
}

/* --- how large it is -------------------------------------------------------------------------- */

/* Operations of a loop, of which functions have many. */
static double loop_size(const kernel_plan *p, const segment *a) {
  unsigned char *needed = segment_needed(p->graph, a);
  double size = 0;
  for (ir_node n = 0; n < ir_count(p->graph); n++)
    if (needed[n] && !ir_is_uniform(p->graph, n))
      size += operations[ir_operation(p->graph, n)].price.operations;
  free(needed);
  const bool written_out = p->form == FORM_UNROLLED && a->kind != OVER_PARTICLES;
  return written_out ? size * p->law->neighbours : size;
}

typedef struct sizing {
  const kernel_plan *plan;
  double largest;
} sizing;

static void find_largest(void *context, const segment *a) {
  sizing *s = context;
  const double size = loop_size(s->plan, a);
  if (size > s->largest) s->largest = size;
}

bool plan_is_large(const kernel_plan *p) {
  sizing s = {.plan = p};
  plan_visit(p, find_largest, &s);
  return s.largest > PLAN_LARGE;
}
