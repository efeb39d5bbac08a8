/* `rate v = ...`: what a state becomes over a step in time. */
#ifndef PERILAT_GENERATOR_LOWER_RATE_H
#define PERILAT_GENERATOR_LOWER_RATE_H

#include "generator/lower/lowering.h"

/* The state at the end of the step, of v' = f(v, t): `rate` is f of the unknown v, which stands as
   `old` in it, at the end of the step; rate_before is what it was at its beginning, IR_NONE of a
   component that nothing keeps. In *rate_after f at the end.

   Where df/dv = -b does not depend on v: with r = rate_before, g = f(old, now), z = b dt

       v = old + dt (phi_1 r + phi_2 (g - r)),  phi_1 = (1 - exp(-z))/z,  phi_2 = (1 - phi_1)/z

   That is exact where f + b v goes evenly over the step and b stays; else of order 2. All other
   rates take a step of implicit Euler, v = old + dt f(v, now), by Newton's method. */
components lower_rate(lowering *c, const stmt *rule, components old, components rate,
                      components rate_before, components *rate_after);

#endif
