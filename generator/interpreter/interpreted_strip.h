/* Programs over strips of bonds or points, and those that know no body, on the interpreter. */
#ifndef PERILAT_GENERATOR_INTERPRETED_STRIP_H
#define PERILAT_GENERATOR_INTERPRETED_STRIP_H

#include "generator/interpreter/runner.h"

/* As a pl_strip_function, a pl_states_function, a pl_point_function, pl_law.prepare and the values
   of pl_law.bounds. No allocation. */
void interpreted_strip(runner *r, program_task task, const double *uniforms, const pl_strip *s);
void interpreted_states(runner *r, program_task task, const double *uniforms, const pl_states *s);
void interpreted_points(runner *r, program_task task, const double *uniforms, const pl_points *s);
void interpreted_tips(runner *r, program_task task, const double *uniforms, const pl_tips *s);
void interpreted_prepare(runner *r, const double *parameters, const pl_bond_class *bonds,
                         double *uniforms);
/* `task`: PROGRAM_BOUNDS or PROGRAM_SIZE_BOUNDS. */
void interpreted_bounds(runner *r, program_task task, const double *parameters, double *lower,
                        double *upper);
/* Of parameters whose defaults read others; the law has such. */
void interpreted_defaults(runner *r, const double *parameters, double *values);

#endif
