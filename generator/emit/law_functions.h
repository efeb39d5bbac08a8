/* Functions that know no body: `prepare`, what is the same for all bonds of a class; `bounds` of
   the parameters; `states` and `tangent`, the law alone, state by state. */
#ifndef PERILAT_GENERATOR_LAW_FUNCTIONS_H
#define PERILAT_GENERATOR_LAW_FUNCTIONS_H

#include "generator/target/expression.h"

void law_functions_of_parameters(emitter *e);
void law_functions_of_states(emitter *e);

#endif
