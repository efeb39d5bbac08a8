#include "generator/plan/plan_roots.h"

#include <stdlib.h>

#include "generator/ir/rewrite.h"
#include "generator/lower/lower.h"
#include "generator/lower/lower_inputs.h"

static void visit_program(const family_program *q, plan_visitor visit, void *context) {
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
  visit_program(&p->step, visit, context);
  visit_program(&p->observe, visit, context);
}

bool plan_reads_rates(const kernel_plan *plan, const lowered_law *step) {
  ir_node rate = lower_quantity(plan->graph, QUANTITY_STRETCH_RATE);
  const ir_node results[] = {step->N, step->M_i, step->M_j, step->F};
  for (int k = 0; k < 4; k++)
    if (results[k] != IR_NONE && rewrite_depends(plan->graph, &results[k], 1, &rate, 1))
      return true;
  return rewrite_depends(plan->graph, step->fields, plan->law->fields.count, &rate, 1);
}
