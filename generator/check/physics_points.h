/* Does a law of a continuum obey mechanics? Its point is driven on the interpreter through random
   strains, in any direction and of any size from 1e-7 to 1e-2, in every setting that the law names.

       rest-force     no stress at rest
       stiffness      the tangent at rest is positive definite: waves run, nothing flies apart
       not-finite     finite strains have finite stresses and tangents
       tangent        the symbolic tangent is the stress's difference
       stored-energy  no energy below that of rest; with states held the tangent is symmetric, so
                      that the stress has an energy
       energy-force   where the law gives both, sigma = dW/dstrain
       continuity     the stress does not jump
       objectivity    a turned strain has the turned stress, unless the law is `anisotropic`
       closed-path    around a closed path of strain nothing is gained
       dissipation    what is lost to states and to rates is never negative */
#ifndef PERILAT_GENERATOR_PHYSICS_POINTS_H
#define PERILAT_GENERATOR_PHYSICS_POINTS_H

#include "generator/check/physics.h"

void physics_check_points(const law *l, const physics_options *o, diagnostics *d,
                          physics_report *report);

#endif
