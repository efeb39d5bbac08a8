/* Work of the forces of a bond around closed paths, without and with the states that change on
   the way. */
#ifndef PERILAT_GENERATOR_PHYSICS_PATHS_H
#define PERILAT_GENERATOR_PHYSICS_PATHS_H

#include "generator/check/physics_report.h"

void physics_check_closed_path(physics *p);
void physics_check_dissipation(physics *p);
/* "0.001, 0, -0.002" or, of stretch and end rotations, "(0.001, 0, 0), ...": the corners after
   the first; of a law that reads the rate "0.001 at 10 1/s" when `rates` has those of the legs,
   "0.001 in 2 s" when `times` has theirs (NULL: no). */
void physics_describe_way(const physics *p, const motion *corners, const double *rates,
                          const double *times, int count, char *text, size_t size);

#endif
