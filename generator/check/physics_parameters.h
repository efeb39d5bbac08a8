/* Parameters and lattice of a law for its physics checks. */
#ifndef PERILAT_GENERATOR_PHYSICS_PARAMETERS_H
#define PERILAT_GENERATOR_PHYSICS_PARAMETERS_H

#include <stdint.h>

#include "dsl/semantics/law.h"
#include "runtime/deck/deck.h"

/* values[parameters]: a log-uniform factor of 0.5 to 2 on every default, kept within the bounds;
   without a seed the defaults (something usual where there is none). */
void physics_draw_parameters(const law *l, uint64_t *seed, double *values);

/* Behind what was found with parameters that were drawn. */
#define PHYSICS_OTHER_VALUES " (a deck is judged with its own values)"

/* The lattice that such laws are written for, without a deck: hexagonal in the plane; in space fcc
   with its second neighbours. */
deck_lattice physics_usual_lattice(const law *l);

#endif
