#include "runtime/analysis/section.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

static bool is_far(const section *s, long site) {
  double at[3], height = 0;
  rows_place(s->of->lattice, site, at);
  for (int d = 0; d < 3; d++)
    height += (at[d] - s->at[d]) * s->normal[d];
  return height >= -1e-6 * s->of->lattice->spacing;
}

static bool crosses(const section *s, long site, int direction, const unsigned char *inside) {
  const rows *g = s->of->lattice;
  if (!rows_has_bond(g, site, direction)) return false;
  const long partner = rows_partner(g, site, direction);
  if (inside && !(inside[site] && inside[partner])) return false;
  return is_far(s, site) != is_far(s, partner);
}

section section_new(const body *of, const double at[3], const double normal[3],
                    const unsigned char *inside) {
  const rows *g = of->lattice;
  const double size = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
  section s = {.of = of};
  for (int d = 0; d < 3; d++) {
    s.at[d] = at[d];
    s.normal[d] = normal[d] / size;
  }
  s.bonds = must_calloc((size_t)g->size, sizeof *s.bonds);
  for (long p = 0; p < g->particle_count; p++)
    for (int k = 0; k < g->directions; k++) {
      const long site = g->particle_site[p];
      if (!crosses(&s, site, k, inside)) continue;
      s.bonds[site] |= UINT64_C(1) << k;
      s.count++;
    }
  return s;
}

void section_free(section *s) {
  free(s->bonds);
}

typedef struct section_sum {
  const section *of;
  double *sum;
} section_sum;

static void add_force(void *to, const bond_force *b) {
  const section_sum *s = to;
  const double *near = is_far(s->of, b->owner) ? b->on_partner : b->on_owner;
  for (int d = 0; d < s->of->of->dimensions; d++)
    s->sum[d] += near[d];
}

static void add_moment(void *to, const bond_force *b) {
  const section_sum *s = to;
  const body *of = s->of->of;
  const bool far = is_far(s->of, b->owner);
  const long site = far ? b->partner : b->owner;
  const double *on = far ? b->on_partner : b->on_owner;
  double arm[3], force[3] = {0, 0, 0};
  rows_place(of->lattice, site, arm);
  for (int d = 0; d < of->dimensions; d++) {
    arm[d] += of->displacement[d][site] - s->of->at[d];
    force[d] = on[d];
  }
  for (int axis = of->dimensions == 2 ? 2 : 0; axis < 3; axis++) {
    const int a = (axis + 1) % 3, c = (axis + 2) % 3;
    s->sum[axis] += arm[a] * force[c] - arm[c] * force[a];
  }
  for (int d = of->dimensions; d < of->dof; d++) /* of particles that turn */
    s->sum[of->dimensions == 2 ? 2 : d - 3] += on[d];
}

static void sum_up(const section *s, bond_forces *f, bond_force_use *add, double sum[3]) {
  section_sum to = {s, sum};
  memset(sum, 0, 3 * sizeof *sum);
  bond_forces_each(f, s->bonds, add, &to);
}

void section_force(const section *s, bond_forces *f, double force[3]) {
  sum_up(s, f, add_force, force);
}

void section_moment(const section *s, bond_forces *f, double moment[3]) {
  sum_up(s, f, add_moment, moment);
}
