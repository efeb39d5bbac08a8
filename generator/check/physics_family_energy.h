/* Work of the forces of a body of families with its states held: rest, stiffness, elastic
   constants, stored energy. */
#ifndef PERILAT_GENERATOR_PHYSICS_FAMILY_ENERGY_H
#define PERILAT_GENERATOR_PHYSICS_FAMILY_ENERGY_H

#include "generator/check/physics_family_bench.h"

void family_check_rest(family_bench *b);
void family_check_stiffness(family_bench *b);
/* Of bonds in space: a twist meets a moment against it. */
void family_check_twist(family_bench *b);
/* Work with the fields held: stored energy, closed ways, what damage does; whole bodies and
   damaged ones. */
void family_check_energy(family_bench *b, bool damaged);
void family_check_energy_and_force(family_bench *b);

#endif
