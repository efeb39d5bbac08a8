#include "runtime/analysis/bar_force.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

static void find_middle(const rows *g, long site, int direction, double middle[3]) {
  double from[3], to[3];
  rows_place(g, site, from);
  rows_place(g, rows_partner(g, site, direction), to);
  for (int d = 0; d < 3; d++)
    middle[d] = 0.5 * (from[d] + to[d]);
}

/* Takes the bond, in place of one that is further away than it. */
static void take(bar_force *b, const double *at, long site, int direction) {
  const rows *g = b->of->lattice;
  double middle[3];
  find_middle(g, site, direction, middle);
  const double distance = at ? bravais_distance(middle, at) : 0;
  if (at && b->count > 0) {
    if (!(distance < b->distance - 1e-6 * g->spacing)) return;
    memset(b->bonds, 0, (size_t)g->size * sizeof *b->bonds);
    b->count = 0;
  }
  b->bonds[site] |= UINT64_C(1) << direction;
  if (b->count++ > 0) return;
  memcpy(b->middle, middle, sizeof middle);
  b->distance = distance;
}

bar_force bar_force_new(const body *of, const double *at, const unsigned char *inside) {
  const rows *g = of->lattice;
  bar_force b = {.of = of, .bonds = must_calloc((size_t)g->size, sizeof *b.bonds)};
  b.axial = must_calloc((size_t)g->directions * (size_t)g->size, sizeof *b.axial);
  for (long p = 0; p < g->particle_count; p++)
    for (int k = 0; k < g->directions; k++) {
      const long site = g->particle_site[p];
      if (rows_has_bond(g, site, k) &&
          (!inside || (inside[site] && inside[rows_partner(g, site, k)])))
        take(&b, at, site, k);
    }
  return b;
}

void bar_force_free(bar_force *b) {
  free(b->bonds);
  free(b->axial);
}

/* Of several laws each adds its part. */
static void add(void *to, const bond_force *bond) {
  const bar_force *b = to;
  const body *of = b->of;
  double from[3], chord[3], along = 0, square = 0;
  rows_place(of->lattice, bond->owner, from);
  rows_place(of->lattice, bond->partner, chord);
  for (int d = 0; d < of->dimensions; d++) {
    chord[d] += of->displacement[d][bond->partner] - from[d] - of->displacement[d][bond->owner];
    along += chord[d] * bond->on_owner[d];
    square += chord[d] * chord[d];
  }
  b->axial[bond->direction * of->lattice->size + bond->owner] += along / sqrt(square);
}

double bar_force_largest(const bar_force *b, bond_forces *f) {
  const rows *g = b->of->lattice;
  double largest = -INFINITY;
  memset(b->axial, 0, (size_t)g->directions * (size_t)g->size * sizeof *b->axial);
  bond_forces_each(f, b->bonds, add, (void *)b);
  for (int k = 0; k < g->directions; k++)
    for (long q = 0; q < g->size; q++)
      if (b->bonds[q] >> k & 1) largest = pl_fmax(largest, b->axial[k * g->size + q]);
  return largest;
}
