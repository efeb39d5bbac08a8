/* Programs of families on the interpreter: the segments of a plan, run as the emitted C runs them,
   to the bit. */
#ifndef PERILAT_GENERATOR_INTERPRETED_FAMILY_H
#define PERILAT_GENERATOR_INTERPRETED_FAMILY_H

#include "generator/interpreter/runner.h"

/* Pass `number` of a program, as a pl_family_function. No allocation. */
void interpreted_family(runner *r, program_task task, int number, const double *uniforms,
                        const pl_family *family);

#endif
