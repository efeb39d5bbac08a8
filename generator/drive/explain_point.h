/* The line of a law that first stops being finite at a point of a continuum. */
#ifndef PERILAT_GENERATOR_EXPLAIN_POINT_H
#define PERILAT_GENERATOR_EXPLAIN_POINT_H

#include <stdio.h>

#include "generator/interpreter/lone_point.h"

typedef enum point_fault {
  POINT_FAULT_OTHER,
  POINT_FAULT_FLOW, /* no step is small enough: the flow never comes back */
  POINT_FAULT_FOLD  /* nor here: no strain along z leaves no stress there */
} point_fault;

/* Names the first quantity of the law, with its line, that is not finite there at rest, a flow that
   does not come back to its limit, or a strain along z that is not found; nothing where all are. Of
   a flow it tells whether f has no slope down, or none that is finite, where it begins, and of the
   strain along z whether there is any: else no step is small enough. */
point_fault explain_point(const kernel_plan *p, const double *parameters, const asked_point *at,
                          FILE *out);

#endif
