/* Forces of a bond near rest, and their derivatives. */
#ifndef PERILAT_GENERATOR_PHYSICS_TANGENT_H
#define PERILAT_GENERATOR_PHYSICS_TANGENT_H

#include "generator/check/physics_report.h"

void physics_check_rest(physics *p);
void physics_check_stiffness(physics *p);
/* `wrong` (tests only): added to the derivative of N by the stretch. */
void physics_check_tangent(physics *p, double wrong);

#endif
