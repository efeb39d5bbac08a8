/* The roots of a plan: what its strips and segments compute. */
#ifndef PERILAT_GENERATOR_PLAN_ROOTS_H
#define PERILAT_GENERATOR_PLAN_ROOTS_H

#include "generator/plan/plan.h"

/* Every root of the plan that a strip or a segment computes, in order. */
typedef void (*plan_visitor)(void *context, const ir_node *roots, int root_count);
void plan_visit(const kernel_plan *p, plan_visitor visit, void *context);
void plan_visit_program(const family_program *q, plan_visitor visit, void *context);

/* Whether forces or new fields depend on the stretch rate. */
bool plan_reads_rates(const kernel_plan *p, const lowered_law *step);

/* Chooses the uniforms, once all roots are known. */
void plan_hoist(kernel_plan *p);
/* What the roots of a pass cost for each bond. */
ir_cost plan_cost(const kernel_plan *p, const pass *a);

#endif
