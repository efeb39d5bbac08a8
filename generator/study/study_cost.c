#include "generator/study/study_cost.h"

#include <math.h>

#include "dsl/base/elementary.h"

/* Sites in the box around a shape. */
static double sites_in(const deck_shape *shape, double spacing) {
  double lower[3], upper[3], count = 1;
  shape_box(shape, lower, upper);
  for (int c = 0; c < 3; c++)
    count *= 1 + (upper[c] - lower[c]) / spacing;
  return count;
}

/* How many bonds a site has grows so with the horizon. */
static double family_of(const deck_lattice *l) {
  const double horizon = l->horizon > 1 ? l->horizon : l->shells > 1 ? l->shells : 1;
  return l->thickness > 0 ? horizon * horizon : horizon * horizon * horizon;
}

static double bonds_of(const deck *k, int lattice) {
  const deck_lattice *l = &k->lattices[lattice];
  double sites = 0;
  for (int b = 0; b < k->body_count; b++)
    if (deck_find_lattice(k, k->bodys[b].lattice) == lattice)
      sites += sites_in(&k->bodys[b].shape, l->spacing);
  return sites * family_of(l);
}

/* A wave takes as many steps across a spacing, whatever the spacing is; at rest comes a body when
   waves have crossed it some times. */
static double steps_of(const deck *k, double finest) {
  const deck_simulation *s = &k->simulation;
  if (k->relaxation.increments > 0) return k->relaxation.increments / finest;
  const double time = s->end_time > 0 ? s->end_time : 1;
  return time / (s->step > 0 ? s->step : s->step_safety * finest / 4000); /* m/s, of concrete */
}

double study_cost(const deck *k) {
  double bonds = 0, finest = INFINITY;
  for (int n = 0; n < k->lattice_count; n++) {
    const double spacing = k->lattices[n].spacing; /* graded: in the middle, where it may be none */
    if (!(spacing > 0 && isfinite(spacing))) continue;
    bonds += bonds_of(k, n);
    finest = pl_fmin(finest, spacing);
  }
  const double cost = bonds * steps_of(k, finest);
  return isfinite(cost) ? cost : 0;
}
