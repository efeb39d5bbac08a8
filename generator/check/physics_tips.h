/* Does a law of cracks make sense? It is asked at many tips, of any K from 1e3 to 1e9 Pa m^(1/2),
   of any mixture of modes, at rest and running.

       rest-force   a tip without stress does not grow
       mirror       with -K_II it does the same, mirrored: `toward` changes its sign, nothing else
       crack-speed  no tip runs backward, or as fast as waves along a surface
       not-finite   direction and speed are finite */
#ifndef PERILAT_GENERATOR_PHYSICS_TIPS_H
#define PERILAT_GENERATOR_PHYSICS_TIPS_H

#include "generator/check/physics.h"

void physics_check_tips(const law *l, const physics_options *o, diagnostics *d,
                        physics_report *report);

#endif
