/* The programs of a law of families: what is wanted of a particle, in the terms of the law. */
#ifndef PERILAT_GENERATOR_PLAN_FAMILY_H
#define PERILAT_GENERATOR_PLAN_FAMILY_H

#include "generator/plan/plan.h"
#include "generator/plan/program.h"

/* Axes along which particles move, and about which those of micropolar laws turn; the law of the
   plan is then for bonds that do. */
void plan_axes(kernel_plan *p);

/* Fills in a plan of families. False after a diagnostic. */
bool plan_programs(kernel_plan *p, diagnostics *d);

/* For programs of families: adds a value of a particle, or toward its neighbours, to what is
   wanted; the components of force and moment on a particle; what takes the place of stretch, rate,
   end rotations, length and direction. */
void plan_want(const kernel_plan *plan, segment *wanted, ir_node node, segment_target target,
               segment_kind over, int index);
void plan_forces(const kernel_plan *plan, const lowered_law *of, segment *wanted);
program_motion plan_motion(const kernel_plan *plan, bool along_reference);

#endif
