/* Sums over the motion of some particles of a body at one instant, whose velocities the caller
   knows (those of a body are half a step before). */
#ifndef PERILAT_RUNTIME_MOMENTUM_H
#define PERILAT_RUNTIME_MOMENTUM_H

#include "runtime/body/body.h"

/* m/s, rad/s: of a site at that instant. */
typedef double velocity_now(const void *from, int component, long site);

typedef struct moving_particles {
  const body *of;
  const int32_t *sites;
  long count;
  velocity_now *velocity;
  const void *from;
} moving_particles;

/* kg m/s; of a rotation kg m^2/s, what particles turn with by themselves. */
double momentum_of(const moving_particles *m, int component);
/* kg m^2/s about an axis through `about` along x, y, z (0, 1, 2; the plane has z alone), with what
   particles turn with by themselves. */
double momentum_angular(const moving_particles *m, const double about[3], int axis);
/* J, as the ledger has it: half m v- v+, the velocities half a step before and after. */
double momentum_kinetic(const moving_particles *m);

#endif
