/* Parameters of a law for its physics checks. */
#ifndef PERILAT_GENERATOR_PHYSICS_PARAMETERS_H
#define PERILAT_GENERATOR_PHYSICS_PARAMETERS_H

#include <stdint.h>

#include "dsl/law.h"

/* values[parameters]: a log-uniform factor of 0.5 to 2 on every default, kept within the bounds; without a seed the defaults
   (something usual where there is none). */
void physics_draw_parameters(const law *l, uint64_t *seed, double *values);

#endif
