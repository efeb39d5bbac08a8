/* A point of a law of a continuum by itself, at rest: the inputs of its graph, and in plane stress
   how the stress along z depends on the strain there. */
#ifndef PERILAT_GENERATOR_LONE_POINT_H
#define PERILAT_GENERATOR_LONE_POINT_H

#include "generator/ir/interpret.h"
#include "generator/plan/plan.h"

/* A point before a step: strain as kernels read it, states, size of the cell. */
typedef struct asked_point {
  const double *strain, *field;
  double size, step, advance; /* m; s, the latter two as of pl_points */
} asked_point;

typedef struct lone_point {
  interpreter_inputs in;
  const double *ends[ENDS_COUNT], **point, **given, **own, **field;
} lone_point;

/* To be closed; must stay where it is, as what is pointed at must. */
void lone_point_open(lone_point *p, const kernel_plan *of, const double *parameters,
                     const asked_point *at);
void lone_point_close(lone_point *p);

/* Strains along z up to four times what the plane is strained by, in steps of a hundredth of that:
   where the stress along z changes its sign, the first time, and how often; where it is least in
   size, and how much, Pa; NaN where no stress there is finite. Where nothing depends on the strain
   along z it has one root. */
typedef struct along_z {
  int roots;
  double root, reach, least_at, least;
} along_z;

along_z lone_point_along_z(lone_point *p, const law *l);

#endif
