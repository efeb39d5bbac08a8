/* Programs of families on the interpreter: the segments of a plan, run as the emitted C runs them,
   to the bit. */
#ifndef PERILAT_GENERATOR_INTERPRETED_FAMILY_H
#define PERILAT_GENERATOR_INTERPRETED_FAMILY_H

#include "generator/plan/plan.h"

typedef struct family_runner family_runner;
typedef enum runner_program { RUN_STEP, RUN_LOSSES, RUN_OBSERVE, RUN_PROGRAMS } runner_program;

/* Working space for one caller at a time. inputs[k] is the input node that stands for uniform k.
   The plan must outlive it. */
family_runner *family_runner_new(const kernel_plan *p, const ir_node *inputs);
void family_runner_free(family_runner *r);

/* Pass `number` of a program, as a pl_family_function. No allocation. */
void family_runner_run(family_runner *r, runner_program which, int number, const double *uniforms,
                       const pl_family *family);

#endif
