/* A bond that is kept as long as it is. */
#ifndef PERILAT_GENERATOR_PHYSICS_HOLD_H
#define PERILAT_GENERATOR_PHYSICS_HOLD_H

#include "generator/check/physics_report.h"

/* A bond that is held may not pull harder and harder (error). */
void physics_check_hold(physics *p);

#endif
