#include "runtime/analysis/particle_tensors.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

/* --- stress ----------------------------------------------------------------------------------- */

/* From the owner to its partner, now. */
static void present_chord(const body *of, const bond_force *b, double chord[3]) {
  rows_chord(of->lattice, b->owner, b->direction, chord);
  for (int d = 0; d < of->dimensions; d++)
    chord[d] += of->displacement[d][b->partner] - of->displacement[d][b->owner];
}

/* The part of an end, J: half of sym(f (x) c), the same for both, whose forces and chords are
   opposite. Returns how many components there are. */
static int virtual_work(const body *of, const bond_force *b, double work[TENSOR_MOST]) {
  double chord[3];
  const tensor_component *t;
  const int count = tensor_components(of->dimensions, &t);
  present_chord(of, b, chord);
  for (int c = 0; c < count; c++)
    work[c] = 0.25 * (b->on_owner[t[c].first] * chord[t[c].second] +
                      b->on_owner[t[c].second] * chord[t[c].first]);
  return count;
}

typedef struct stress_field {
  const body *of;
  double *const *stress;
} stress_field;

static void add_to_field(void *to, const bond_force *b) {
  const stress_field *s = to;
  double work[TENSOR_MOST];
  const int count = virtual_work(s->of, b, work);
  for (int c = 0; c < count; c++) {
    s->stress[c][b->owner] += work[c];
    s->stress[c][b->partner] += work[c];
  }
}

void particle_stress(bond_forces *f, const body *of, double *const *stress) {
  const rows *g = of->lattice;
  const tensor_component *t;
  const int count = tensor_components(of->dimensions, &t);
  stress_field s = {of, stress};
  for (int c = 0; c < count; c++)
    memset(stress[c], 0, (size_t)g->size * sizeof(double));
  bond_forces_each(f, NULL, add_to_field, &s);
  for (int c = 0; c < count; c++)
    for (long p = 0; p < g->particle_count; p++)
      stress[c][g->particle_site[p]] /= rows_stressed_volume(g, g->particle_site[p]);
}

/* --- strain ----------------------------------------------------------------------------------- */

/* Sums over the bonds of a site: n n^T, and h n^T, h the change of the chord over its length. */
static void fit_sums(const body *of, long site, double directions[3][3], double changes[3][3]) {
  const rows *g = of->lattice;
  for (int k = 0; k < 2 * g->directions; k++) {
    double chord[3];
    if (!rows_has_neighbour(g, site, k)) continue;
    const double length = rows_chord(g, site, k, chord);
    const long partner = rows_partner(g, site, k);
    for (int a = 0; a < of->dimensions; a++) {
      const double change = of->displacement[a][partner] - of->displacement[a][site];
      for (int b = 0; b < of->dimensions; b++) {
        directions[a][b] += chord[a] * chord[b] / (length * length);
        changes[a][b] += change * chord[b] / (length * length);
      }
    }
  }
}

/* By minors; false where it is singular, to rounding. */
static bool invert(double m[3][3], double inverse[3][3]) {
  static const double least = 1e-6;
  const double mean = (m[0][0] + m[1][1] + m[2][2]) / 3;
  double det = 0;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) {
      const int r = (b + 1) % 3, s = (b + 2) % 3, u = (a + 1) % 3, v = (a + 2) % 3;
      inverse[a][b] = m[r][u] * m[s][v] - m[r][v] * m[s][u];
    }
  for (int b = 0; b < 3; b++)
    det += m[0][b] * inverse[b][0];
  if (!(det > least * mean * mean * mean)) return false;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      inverse[a][b] /= det;
  return true;
}

/* The gradient of displacements that fits the bonds of a site; NaN where they do not span. */
static void fit(const body *of, long site, double gradient[3][3]) {
  double directions[3][3] = {{0}}, changes[3][3] = {{0}}, inverse[3][3];
  fit_sums(of, site, directions, changes);
  if (of->dimensions == 2) directions[2][2] = 1;
  const bool spans = invert(directions, inverse);
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) {
      gradient[a][b] = spans ? 0 : NAN;
      for (int c = 0; c < 3 && spans; c++)
        gradient[a][b] += changes[a][c] * inverse[c][b];
    }
}

void particle_strain(const body *of, long site, double strain[TENSOR_MOST]) {
  double gradient[3][3];
  const tensor_component *t;
  const int count = tensor_components(of->dimensions, &t);
  fit(of, site, gradient);
  for (int c = 0; c < count; c++) {
    const int a = t[c].first, b = t[c].second;
    double twice = gradient[a][b] + gradient[b][a];
    for (int k = 0; k < of->dimensions; k++)
      twice += gradient[k][a] * gradient[k][b];
    strain[c] = 0.5 * twice;
  }
}

/* --- of a region ------------------------------------------------------------------------------ */

tensor_region tensor_region_new(const body *of, const int32_t *sites, long count) {
  const rows *g = of->lattice;
  tensor_region r = {.of = of, .sites = sites, .count = count};
  r.inside = must_calloc((size_t)g->size, sizeof *r.inside);
  r.bonds = must_calloc((size_t)g->size, sizeof *r.bonds);
  for (long p = 0; p < count; p++) {
    const long site = sites[p];
    r.inside[site] = 1;
    r.volume += rows_stressed_volume(g, site);
    r.bonds[site] |= g->bonds[site];
    for (int k = 0; k < g->directions; k++)
      if (rows_has_neighbour(g, site, k + g->directions))
        r.bonds[rows_partner(g, site, k + g->directions)] |= UINT64_C(1) << k;
  }
  return r;
}

void tensor_region_free(tensor_region *r) {
  free(r->inside);
  free(r->bonds);
}

typedef struct region_sum {
  const tensor_region *region;
  double *sum;
} region_sum;

static void add_to_region(void *to, const bond_force *b) {
  const region_sum *s = to;
  const int ends = s->region->inside[b->owner] + s->region->inside[b->partner];
  double work[TENSOR_MOST];
  const int count = virtual_work(s->region->of, b, work);
  for (int c = 0; c < count; c++)
    s->sum[c] += ends * work[c];
}

void tensor_region_stress(const tensor_region *r, bond_forces *f, double stress[TENSOR_MOST]) {
  region_sum s = {r, stress};
  memset(stress, 0, TENSOR_MOST * sizeof *stress);
  bond_forces_each(f, r->bonds, add_to_region, &s);
  for (int c = 0; c < TENSOR_MOST; c++)
    stress[c] /= r->volume;
}

void tensor_region_strain(const tensor_region *r, double strain[TENSOR_MOST]) {
  double volume = 0;
  memset(strain, 0, TENSOR_MOST * sizeof *strain);
  for (long p = 0; p < r->count; p++) {
    const double V = rows_stressed_volume(r->of->lattice, r->sites[p]);
    double here[TENSOR_MOST] = {0};
    particle_strain(r->of, r->sites[p], here);
    if (isnan(here[0])) continue;
    volume += V;
    for (int c = 0; c < TENSOR_MOST; c++)
      strain[c] += V * here[c];
  }
  for (int c = 0; c < TENSOR_MOST; c++)
    strain[c] /= volume;
}
