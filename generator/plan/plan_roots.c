#include "generator/plan/plan_roots.h"

#include <stdlib.h>

#include "generator/ir/rewrite.h"
#include "generator/lower/lower.h"
#include "generator/lower/lower_inputs.h"

void plan_visit_program(const family_program *q, plan_visitor visit, void *context) {
  for (int k = 0; k < q->pass_count; k++)
    for (int s = 0; s < q->passes[k].segment_count; s++) {
      const segment *a = &q->passes[k].segments[s];
      ir_node *nodes = must_alloc(((size_t)a->root_count + 1) * sizeof *nodes);
      for (int r = 0; r < a->root_count; r++)
        nodes[r] = a->roots[r].node;
      visit(context, nodes, a->root_count);
      free(nodes);
    }
}

void plan_visit(const kernel_plan *p, plan_visitor visit, void *context) {
  for (int k = 0; k < PASS_COUNT; k++) {
    const pass *a = &p->passes[k];
    if (k == PASS_BOUNDS) continue;
    ir_node *nodes = must_alloc(((size_t)a->root_count + 1) * sizeof *nodes);
    for (int r = 0; r < a->root_count; r++)
      nodes[r] = a->roots[r].node;
    visit(context, nodes, a->root_count);
    free(nodes);
  }
  plan_visit_program(&p->step, visit, context);
  plan_visit_program(&p->losses, visit, context);
  plan_visit_program(&p->observe, visit, context);
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

static void mark_hoisted_of_roots(void *context, const ir_node *roots, int root_count) {
  const hoisting *h = context;
  const ir *g = h->graph;
  unsigned char *needed = must_calloc((size_t)ir_count(g) + 1, 1);
  ir_mark(g, roots, root_count, needed);
  for (int k = 0; k < root_count; k++)
    mark_hoisted(g, roots[k], h->hoisted);
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

ir_cost plan_cost(const kernel_plan *p, const pass *a) {
  ir_node *nodes = must_alloc(((size_t)a->root_count + 1) * sizeof *nodes);
  for (int k = 0; k < a->root_count; k++)
    nodes[k] = a->roots[k].node;
  ir_cost cost = ir_count_cost(p->graph, nodes, a->root_count, ON_PARTICLE);
  free(nodes);
  return cost;
}
