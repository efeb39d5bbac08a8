/* Inside of the planning of kernels, shared by its parts: passes.c plans strips of bonds, plan_family.c programs of
   families. */
#ifndef PERILAT_GENERATOR_PLAN_PARTS_H
#define PERILAT_GENERATOR_PLAN_PARTS_H

#include "generator/plan/passes.h"

/* An empty plan. */
kernel_plan *plan_begin(const law *l);
/* Bounds of parameters as PASS_BOUNDS. False after a diagnostic. */
bool plan_bounds(kernel_plan *p, diagnostics *d);
/* Chooses the uniforms, once all roots are known. */
void plan_hoist(kernel_plan *p);
/* Fills in a plan of families. False after a diagnostic. */
bool plan_programs(kernel_plan *p, diagnostics *d);

/* For programs of families: the components of the force on a particle (roots[dimensions]), and what
   takes the place of stretch, rate, length and direction. */
void plan_forces(const kernel_plan *plan, const lowered_law *of, segment_root *roots);
program_motion plan_motion(const kernel_plan *plan, bool along_reference);

/* What the roots of a pass cost for each bond. */
ir_cost plan_cost(const kernel_plan *p, const pass *a);

#endif
