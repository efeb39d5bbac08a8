/* Where a law of bonds is driven: along rays from rest, and through random histories. */
#ifndef PERILAT_GENERATOR_PHYSICS_STATES_H
#define PERILAT_GENERATOR_PHYSICS_STATES_H

#include "generator/check/physics_report.h"

/* Motion drawn log-uniformly, in half of the draws near one at which a guard changes. */
motion physics_draw_motion(physics *p);
/* A corner of a loop: of either sign and within a decade of the amplitude on every axis, so that
 * steps resolve the legs. */
motion physics_draw_corner(physics *p, motion amplitude);
/* Along rays from rest and from the pool: finds guards, both sides of which go to the pool;
 * continuity and flow. */
void physics_scan(physics *p, int rays, bool from_rest);
/* Random histories from rest; exchange, mirror, range of damages, finite forces. Fills the pool. */
void physics_histories(physics *p, int legs);

#endif
