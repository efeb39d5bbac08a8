/* The roots of a plan: what the segments of its programs compute. */
#ifndef PERILAT_GENERATOR_PLAN_ROOTS_H
#define PERILAT_GENERATOR_PLAN_ROOTS_H

#include "generator/plan/plan.h"

/* A program of one pass with one segment; its segment. */
segment *plan_single(kernel_plan *p, program_task task, const char *name, segment_kind kind);

/* Every segment of the plan but that of bounds, in order. */
typedef void (*plan_visitor)(void *context, const segment *a);
void plan_visit(const kernel_plan *p, plan_visitor visit, void *context);
void plan_visit_program(const kernel_program *q, plan_visitor visit, void *context);

/* Whether forces or new fields depend on the stretch rate. */
bool plan_reads_rates(const kernel_plan *p, const lowered_law *step);

/* Chooses the uniforms, once all roots are known. */
void plan_hoist(kernel_plan *p);
/* Marks what follows from the step in time, or `dt`, with uniforms and numbers alone: one number of
   a whole record, known before its loop. mask: [nodes], zeroed here. */
void plan_mark_of_time(const kernel_plan *p, unsigned char *mask);
/* What the roots of a segment cost each time, but for what is of time: operations placed `at_least`
   so locally. */
ir_cost plan_cost(const kernel_plan *p, const segment *a, placement at_least);
/* What a step costs for each bond: of a strip, or of either side of it. */
void plan_count_cost(kernel_plan *p);
/* Whether some loop is large (kernel_plan.large). */
bool plan_is_large(const kernel_plan *p);

#endif
