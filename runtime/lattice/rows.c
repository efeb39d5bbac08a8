#include "runtime/lattice/rows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/base/hash.h"

#define CHORD_TOLERANCE 1e-9 /* spacings: a chord must enter a notch deeper than this to be cut */

void *rows_array(long count, size_t each) {
  const size_t bytes = (size_t)count * each;
  const size_t whole = (bytes + PL_ALIGNMENT - 1) / PL_ALIGNMENT * PL_ALIGNMENT;
  void *p = aligned_alloc(PL_ALIGNMENT, whole);
  return p != NULL ? memset(p, 0, whole) : NULL;
}

bool rows_new_sites(rows *w) {
  w->bonds = rows_array(w->size, sizeof *w->bonds);
  w->held_bonds = rows_array(w->size, sizeof *w->held_bonds);
  w->held = rows_array(w->size, sizeof *w->held);
  w->present = rows_array(w->size, 1);
  w->x = rows_array(w->size, sizeof *w->x);
  w->y = rows_array(w->size, sizeof *w->y);
  if (w->dimensions == 3) w->z = rows_array(w->size, sizeof *w->z);
  w->site_particle = rows_array(w->size, sizeof *w->site_particle);
  return w->bonds && w->held_bonds && w->held && w->present && w->x && w->y &&
         (w->z || w->dimensions == 2) && w->site_particle;
}

void rows_find_extent(rows *w) {
  double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (long p = 0; p < w->particle_count; p++) {
    double at[3];
    rows_place(w, w->particle_site[p], at);
    for (int c = 0; c < 3; c++) {
      lower[c] = pl_fmin(lower[c], at[c]);
      upper[c] = pl_fmax(upper[c], at[c]);
    }
  }
  w->width = upper[0] - lower[0];
  w->height = upper[1] - lower[1];
  w->depth = upper[2] - lower[2];
}

void rows_count_bonds(rows *w) {
  w->bond_count = 0;
  for (long p = 0; p < w->particle_count; p++)
    w->bond_count += __builtin_popcountll(w->bonds[w->particle_site[p]]);
}

static bool chord_cut(const rows *w, long site, int k, const deck_shape *shape) {
  double a[3], c[3];
  rows_place(w, site, a);
  rows_place(w, rows_partner(w, site, k), c);
  return shape_crossed(shape, a, c, CHORD_TOLERANCE * w->spacing);
}

static void cut_bond(rows *w, long site, int k) {
  const uint64_t bit = UINT64_C(1) << k;
  w->bonds[site] &= ~bit;
  if (w->list) w->list->incoming[rows_partner(w, site, k)] &= ~bit;
}

long rows_cut(rows *w, long site, const deck_shape *shape) {
  long count = 0;
  for (int k = 0; k < w->directions && w->present[site]; k++) {
    if (!w->present[rows_partner(w, site, k)] || !chord_cut(w, site, k, shape)) continue;
    cut_bond(w, site, k);
    count++;
  }
  return count;
}

static void free_list(neighbour_list *l) {
  if (l == NULL) return;
  free(l->neighbour);
  free(l->incoming);
  free(l->length);
  free(l->alike);
  free(l->way);
  for (int a = 0; a < 3; a++)
    free(l->chord[a]);
  free(l);
}

void rows_free(rows *w) {
  if (w == NULL) return;
  free_list(w->list);
  free(w->site_volume);
  free(w->site_mass);
  free(w->own_size);
  free(w->row_class);
  free(w->bonds);
  free(w->held_bonds);
  free(w->held);
  free(w->present);
  free(w->x);
  free(w->y);
  free(w->z);
  free(w->particle_site);
  free(w->site_particle);
  free(w->copies);
  free(w);
}

/* Bits of the bonds that others own, of a list. */
static uint64_t *incoming_of(const rows *w) {
  uint64_t *incoming = rows_array(w->size, sizeof *incoming);
  for (long p = 0; incoming && p < w->particle_count; p++)
    for (int k = 0; k < w->directions; k++)
      if (rows_has_bond(w, w->particle_site[p], k))
        incoming[rows_partner(w, w->particle_site[p], k)] |= UINT64_C(1) << k;
  return incoming;
}

rows *rows_part(const rows *w, uint64_t *bonds) {
  rows *part = must_alloc(sizeof *part);
  *part = *w;
  part->bonds = bonds;
  rows_count_bonds(part);
  if (!w->list) return part;
  part->list = must_alloc(sizeof *part->list);
  *part->list = *w->list;
  part->list->incoming = incoming_of(part);
  return part;
}

void rows_part_free(rows *part) {
  if (!part) return;
  if (part->list) free(part->list->incoming);
  free(part->list);
  free(part->bonds);
  free(part);
}

int rows_degree(const rows *w, long site) {
  int count = __builtin_popcountll(w->bonds[site]);
  if (w->list) return count + __builtin_popcountll(w->list->incoming[site]);
  for (int k = w->directions; k < 2 * w->directions; k++)
    count += rows_has_neighbour(w, site, k);
  return count;
}

static double volume_of(const rows *w, long site) {
  return w->site_volume ? w->site_volume[site] : w->volume;
}

void rows_set_density(rows *w, double rho) {
  const double half = w->spacing / 2;
  w->mass = rho * w->volume;
  for (long q = 0; w->site_mass && q < w->size; q++)
    w->site_mass[q] = rho * volume_of(w, q);
  w->inertia = 0.4 * w->mass * half * half;
}

/* That of all, where all are alike, to the last bit. */
static double middle_density(const rows *w, const double *rho) {
  double least = INFINITY, most = 0;
  for (long p = 0; p < w->particle_count; p++) {
    least = pl_fmin(least, rho[w->particle_site[p]]);
    most = pl_fmax(most, rho[w->particle_site[p]]);
  }
  return 0.5 * (least + most);
}

void rows_set_densities(rows *w, const double *rho) {
  if (!w->site_mass)
    w->site_mass = must_align(PL_ALIGNMENT, (size_t)w->size * sizeof *w->site_mass);
  rows_set_density(w, middle_density(w, rho));
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    w->site_mass[site] = rho[site] * volume_of(w, site);
  }
}

double rows_radius_square(const rows *w, long site) {
  if (w->own_size) return w->own_size[site] * w->own_size[site];
  if (!w->site_volume) return 1;
  return pl_pow(w->site_volume[site] / w->volume, 2.0 / (w->area > 0 ? 1 : w->dimensions));
}

/* Bonds of a full family; on lists their mean. */
static double family_size(const rows *w) {
  if (!w->list) return 2 * w->directions;
  return round(2 * (double)w->bond_count / (double)w->particle_count);
}

pl_bond_class rows_bond_class(const rows *w, int direction) {
  const int k = direction % w->directions;
  const double sign = direction < w->directions || w->list ? 1 : -1;
  return (pl_bond_class){
      .size = sizeof(pl_bond_class),
      .s = w->length[k],
      .spacing = w->spacing,
      .t = w->stiffness_thickness,
      .area = w->area,
      .V = w->volume,
      .mass_i = w->mass,
      .mass_j = w->mass,
      .shell = w->shell[k],
      .n = family_size(w),
      .chord = {sign * w->chord[k][0], sign * w->chord[k][1], sign * w->chord[k][2]},
      .horizon = w->horizon,
      .weight = w->weight[k]};
}

uint64_t rows_fingerprint(const rows *w) {
  uint64_t hash = HASH_START;
  if (!w->list) return 0;
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    double of[4] = {0, 0, 0, w->site_volume[site]};
    const uint64_t bonds[2] = {w->bonds[site], w->list->incoming[site]};
    rows_place(w, site, of);
    hash = hash_words(hash, of, 4);
    if (w->own_size) hash = hash_words(hash, &w->own_size[site], 1);
    hash = hash_words(hash, bonds, 2);
  }
  return hash ? hash : 1;
}

const char *rows_place_text(int dimensions, const double at[3], char text[ROWS_PLACE_TEXT]) {
  if (dimensions == 2)
    snprintf(text, ROWS_PLACE_TEXT, "(%.6g, %.6g) mm", 1e3 * at[0], 1e3 * at[1]);
  else
    snprintf(text, ROWS_PLACE_TEXT, "(%.6g, %.6g, %.6g) mm", 1e3 * at[0], 1e3 * at[1], 1e3 * at[2]);
  return text;
}

rows_bond *rows_bonds(const rows *w) {
  rows_bond *bonds = must_alloc(((size_t)w->bond_count + 1) * sizeof *bonds);
  long next = 0;
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    for (int k = 0; k < w->directions; k++) {
      if (!rows_has_bond(w, site, k)) continue;
      bonds[next++] = (rows_bond){.i = (int32_t)p,
                                  .j = w->site_particle[rows_partner(w, site, k)],
                                  .slot = (int64_t)k * w->size + site};
    }
  }
  return bonds;
}
