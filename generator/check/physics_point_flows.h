/* What the flows of a point remove of the overstress. */
#ifndef PERILAT_GENERATOR_PHYSICS_POINT_FLOWS_H
#define PERILAT_GENERATOR_PHYSICS_POINT_FLOWS_H

#include "generator/check/physics_point_bench.h"

/* The flows of a law on their own, in the bench's setting. NULL: none has a guard that is an
   overstress. */
typedef struct point_flows point_flows;
point_flows *point_flows_open(point_bench *b);
void point_flows_close(point_flows *f);
/* The virgin point under a drawn strain, beyond its limit: one that is returned must be at the
   limit afterwards, any other must have come nearer. The strain along z is one more to draw. */
void physics_check_flows(point_bench *b, point_flows *f);

#endif
