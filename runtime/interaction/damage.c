#include "runtime/interaction/damage.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

static bool counts(const pl_field *field, bool on_particles) {
  const bool particle = field->place == PL_ON_PARTICLE || field->place == PL_ON_POINT;
  return field->kind == PL_FIELD_DAMAGE && particle == on_particles;
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

bool damage_on_any(const pl_law *law) {
  return damage_on_bonds(law) || damage_on_particles(law);
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

const double *damage_of_all_bonds_in(const sweep *w, double *const *field) {
  const double *only = NULL;
  for (int f = 0; f < w->law->field_count; f++) {
    if (!counts(&w->law->fields[f], false)) continue;
    if (only || w->law->fields[f].place != PL_ON_BOND) return NULL;
    only = field[f];
  }
  return only;
}

const double *damage_of_all_bonds(const sweep *w) {
  return damage_of_all_bonds_in(w, w->new_field);
}

/* The particle is one of the law, where several are at work. */
static bool is_of_law(const sweep *w, long site) {
  return !w->share || w->share[site] > 0;
}

/* Adds up the damage of the bonds of each particle, and counts these. */
static void add_bonds(const damage_law *l, double *sum, int32_t *count) {
  const rows *g = l->of->lattice;
  for (long b = 0; b < l->bond_count; b++) {
    const int32_t ends[2] = {l->bonds[b].i, l->bonds[b].j};
    const double damage = damage_of_bond(l->of, &l->bonds[b]);
    for (int e = 0; e < 2; e++) {
      if (!is_of_law(l->of, g->particle_site[ends[e]])) continue;
      sum[ends[e]] += damage;
      count[ends[e]]++;
    }
  }
}

static void take_particles(const sweep *w, double *values) {
  for (long p = 0; p < w->lattice->particle_count; p++)
    if (is_of_law(w, w->lattice->particle_site[p]))
      values[p] = damage_of_site(w, w->lattice->particle_site[p]);
}

void damage_of_particles(const damage_law *laws, int count, double *values) {
  const long particles = laws[0].of->lattice->particle_count;
  int32_t *bonds = must_calloc((size_t)particles, sizeof *bonds);
  memset(values, 0, (size_t)particles * sizeof *values);
  for (int n = 0; n < count; n++)
    if (!damage_on_particles(laws[n].of->law)) add_bonds(&laws[n], values, bonds);
  for (long p = 0; p < particles; p++)
    if (bonds[p]) values[p] /= bonds[p];
  for (int n = 0; n < count; n++)
    if (damage_on_particles(laws[n].of->law)) take_particles(laws[n].of, values);
  free(bonds);
}
