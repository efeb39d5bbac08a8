/* Objectivity of a law of a continuum: turned with its strain, a point has the turned stress. Of a
   law that says that it is anisotropic nothing is asked: its axes stay with the material, which
   small strains do not turn. */
#ifndef PERILAT_GENERATOR_PHYSICS_POINT_TURNS_H
#define PERILAT_GENERATOR_PHYSICS_POINT_TURNS_H

#include "generator/check/physics_point_bench.h"

/* At one drawn strain and turn. */
void physics_check_turns(point_bench *b);

#endif
