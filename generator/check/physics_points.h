/* Does a law of a continuum obey mechanics? Its point is driven on the interpreter through random
   strains, in any direction and of any size from 1e-7 to 1e-2.

       rest-force     no stress at rest
       stiffness      the tangent at rest is positive definite: waves run, nothing flies apart
       tangent        the symbolic tangent is the stress's difference
       stored-energy  with states held the tangent is symmetric: the stress has an energy
       energy-force   where the law gives both, sigma = dW/dstrain
       closed-path    around a closed path of strain nothing is gained
       dissipation    what is lost to states and to rates is never negative
       not-finite     finite strains have finite stresses */
#ifndef PERILAT_GENERATOR_PHYSICS_POINTS_H
#define PERILAT_GENERATOR_PHYSICS_POINTS_H

#include "generator/check/physics.h"

void physics_check_points(const law *l, const physics_options *o, diagnostics *d,
                          physics_report *report);

#endif
