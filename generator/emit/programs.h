/* Programs of families as C: one function for each pass, in the form that the plan names, and the
   tables of both programs. */
#ifndef PERILAT_GENERATOR_PROGRAMS_H
#define PERILAT_GENERATOR_PROGRAMS_H

#include "generator/target/expression.h"

void programs_functions(emitter *e);

#endif
