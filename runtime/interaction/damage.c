#include "runtime/interaction/damage.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

static bool counts(const pl_field *field, bool on_particles) {
  return field->kind == PL_FIELD_DAMAGE && (field->place == PL_ON_PARTICLE) == on_particles;
}

static bool has_damage(const pl_law *law, bool on_particles) {
  for (int f = 0; f < law->field_count; f++)
    if (counts(&law->fields[f], on_particles)) return true;
  return false;
}

bool damage_on_bonds(const pl_law *law) {
  return has_damage(law, false);
}

bool damage_on_particles(const pl_law *law) {
  return has_damage(law, true);
}

double damage_of_bond_in(const sweep *w, double *const *field, const rows_bond *bond) {
  double most = 0;
  for (int f = 0; f < w->law->field_count; f++) {
    if (!counts(&w->law->fields[f], false)) continue;
    const double here = sweep_bond_value(w, field[f], bond);
    if (here > most) most = here;
  }
  return most;
}

double damage_of_bond(const sweep *w, const rows_bond *bond) {
  return damage_of_bond_in(w, w->new_field, bond);
}

double damage_of_site_in(const sweep *w, double *const *field, long site) {
  double most = 0;
  for (int f = 0; f < w->law->field_count; f++)
    if (counts(&w->law->fields[f], true) && field[f][site] > most) most = field[f][site];
  return most;
}

double damage_of_site(const sweep *w, long site) {
  return damage_of_site_in(w, w->new_field, site);
}

const double *damage_of_all_bonds(const sweep *w) {
  const double *only = NULL;
  for (int f = 0; f < w->law->field_count; f++) {
    if (!counts(&w->law->fields[f], false)) continue;
    if (only || w->law->fields[f].place != PL_ON_BOND) return NULL;
    only = w->new_field[f];
  }
  return only;
}

static void mean_over_bonds(const sweep *w, const rows_bond *bonds, double *values) {
  const rows *g = w->body->lattice;
  int32_t *count = must_calloc((size_t)g->particle_count, sizeof *count);
  memset(values, 0, (size_t)g->particle_count * sizeof *values);
  for (long b = 0; b < g->bond_count; b++) {
    const int32_t ends[2] = {bonds[b].i, bonds[b].j};
    const double damage = damage_of_bond(w, &bonds[b]);
    for (int e = 0; e < 2; e++) {
      values[ends[e]] += damage;
      count[ends[e]]++;
    }
  }
  for (long p = 0; p < g->particle_count; p++)
    if (count[p]) values[p] /= count[p];
  free(count);
}

void damage_of_particles(const sweep *w, const rows_bond *bonds, double *values) {
  if (!damage_on_particles(w->law)) {
    mean_over_bonds(w, bonds, values);
    return;
  }
  for (long p = 0; p < w->body->lattice->particle_count; p++)
    values[p] = damage_of_site(w, w->body->lattice->particle_site[p]);
}
