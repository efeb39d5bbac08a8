/* The particles of a body in boxes (bins.h), so that those near a place, such as that of a bar's
   particle, are found without asking all. */
#ifndef PERILAT_RUNTIME_NEAR_PARTICLES_H
#define PERILAT_RUNTIME_NEAR_PARTICLES_H

#include "runtime/geometry/bins.h"
#include "runtime/lattice/rows.h"

typedef struct near_particle {
  int32_t particle;
  double way[3]; /* m, from the place; way[2] is 0 in the plane */
  double square; /* m^2, of the distance */
} near_particle;

typedef struct near_particles {
  const rows *body;
  double reach;  /* m */
  double *at[3]; /* [particles of the body] m; NULL along z in the plane */
  bins bins;
  near_particle *found; /* [count] those of the last question, in the order of their numbers */
  long count, room;
} near_particles;

/* The body's rows must stay. */
near_particles near_particles_of(const rows *body, double reach);
/* Finds those at most `reach` away from a place. */
void near_particles_find(near_particles *n, const double from[3]);
void near_particles_end(near_particles *n);

#endif
