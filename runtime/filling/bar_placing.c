#include "runtime/filling/bar_placing.h"

#include <math.h>

#include "dsl/base/elementary.h"
#include "runtime/lattice/near_particles.h"

/* Not finite where none is in reach. */
static double distance_to(near_particles *n, const double from[3]) {
  double nearest = INFINITY;
  near_particles_find(n, from);
  for (long k = 0; k < n->count; k++)
    nearest = pl_fmin(nearest, n->found[k].square);
  return sqrt(nearest);
}

bar_placing bar_placing_in(const rows *bar, const rows *body) {
  const double rounding = 1e-6 * body->spacing;
  bar_placing found = {.least = INFINITY};
  near_particles near = near_particles_of(body, body->spacing + rounding);
  for (long n = 0; n < bar->particle_count; n++) {
    double at[3];
    rows_place(bar, bar->particle_site[n], at);
    const double distance = distance_to(&near, at);
    if (!isfinite(distance)) continue;
    found.inside++;
    found.least = pl_fmin(found.least, distance);
    found.most = pl_fmax(found.most, distance);
    found.mean += distance;
  }
  if (found.inside) found.mean /= (double)found.inside;
  near_particles_end(&near);
  return found;
}
