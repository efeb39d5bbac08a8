/* The physics checks of laws of families (see physics.h): a free body of a few particles, and the perfect lattice, driven on
   the interpreter. What holds by construction is not checked: bond forces are means of both sides, opposite to the bit, and
   stretches know no rotation. */
#ifndef PERILAT_GENERATOR_PHYSICS_FAMILY_H
#define PERILAT_GENERATOR_PHYSICS_FAMILY_H

#include "generator/check/physics.h"

/* As physics_check, for a law of families. */
bool physics_check_family(const law *l, const physics_options *o, diagnostics *d,
                          physics_report *report);

#endif
