/* The line of a law that first stops being finite at a point of a continuum; what lines are named
   by. */
#ifndef PERILAT_GENERATOR_EXPLAIN_POINT_H
#define PERILAT_GENERATOR_EXPLAIN_POINT_H

#include <stdio.h>

#include "generator/plan/plan.h"

/* A point before a step: strain as kernels read it, states, size of the cell. */
typedef struct asked_point {
  const double *strain, *field;
  double size, step; /* m, s */
} asked_point;

/* Names the first quantity of the law, with its line, that is not finite there at rest, a flow that
   does not come back to its limit, or a strain along z that is not found; nothing where all are.
   Whether it is a flow whose f has no slope down, or none that is finite, where it begins (told,
   too): no step is small enough for it. */
bool explain_point(const kernel_plan *p, const double *parameters, const asked_point *at,
                   FILE *out);

/* Named values that a program of one segment needs, in the order of evaluation; to be freed. An
   unnamed one may be infinite and yet not matter: it may stand in a case that is not taken. */
ir_node *explain_named_values(const kernel_plan *p, program_task task, int *count);
/* "  FILE:LINE: the law's `NAME` WHAT there" */
void explain_line(const kernel_plan *p, ir_node n, const char *what, FILE *out);

#endif
