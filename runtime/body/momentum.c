#include "runtime/body/momentum.h"

double momentum_of(const moving_particles *m, int component) {
  double sum = 0;
  for (long p = 0; p < m->count; p++)
    sum += body_mass(m->of, component, m->sites[p]) * m->velocity(m->from, component, m->sites[p]);
  return sum;
}

/* From `about` to where the particle is now, in a direction. */
static double arm(const body *of, const double about[3], int direction, long site) {
  double at[3];
  rows_place(of->lattice, site, at);
  return at[direction] + of->displacement[direction][site] - about[direction];
}

/* The degree of freedom that turns about an axis; -1: none. */
static int spin_about(const body *of, int axis) {
  if (of->dimensions == 2) return of->dof > 2 ? 2 : -1;
  return of->dof > 3 ? 3 + axis : -1;
}

double momentum_angular(const moving_particles *m, const double about[3], int axis) {
  const int a = (axis + 1) % 3, b = (axis + 2) % 3, spin = spin_about(m->of, axis);
  double sum = spin < 0 ? 0 : momentum_of(m, spin);
  for (long p = 0; p < m->count; p++) {
    const long q = m->sites[p];
    sum += body_mass(m->of, 0, q) * (arm(m->of, about, a, q) * m->velocity(m->from, b, q) -
                                     arm(m->of, about, b, q) * m->velocity(m->from, a, q));
  }
  return sum;
}

double momentum_kinetic(const moving_particles *m) {
  double sum = 0;
  for (int d = 0; d < m->of->dof; d++)
    for (long p = 0; p < m->count; p++) {
      const long q = m->sites[p];
      const double before = m->of->velocity[d][q], after = 2 * m->velocity(m->from, d, q) - before;
      sum += 0.5 * body_mass(m->of, d, q) * before * after;
    }
  return sum;
}
