/* The line of a law that first stops being finite at a point of a continuum. */
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

#endif
