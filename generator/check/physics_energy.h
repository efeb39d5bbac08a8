/* Work of the forces of a bond: is it stored, is it lost by damage, is it what the law gives as
   its energy? */
#ifndef PERILAT_GENERATOR_PHYSICS_ENERGY_H
#define PERILAT_GENERATOR_PHYSICS_ENERGY_H

#include "generator/check/physics_report.h"

typedef struct work_done {
  double work, size; /* J; of the path's force times way, and of its absolute value */
  bool known;        /* a stress-free state was found to start from */
} work_done;
/* Work of the rate-free forces with the fields at hand from the stress-free state to each state,
 * along a straight path. */
void physics_work(physics *p, double *const *states, int count, int panels, work_done *out);
void physics_check_stored_energy(physics *p);
void physics_check_damage_force(physics *p);
void physics_check_energy_and_force(physics *p);
/* At states just beyond a yield limit: the energy stored may not rise by the flow. */
bool physics_flow_gains(physics *p, double *const *states, int lane, double *gain, double *stored);

#endif
