#include "runtime/lattice/regions.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/geometry/gmsh_mesh.h"
#include "runtime/lattice/rows_select.h"

/* "x = 0 .. 80 mm, y = 0 .. 40 mm" */
static void extent_text(const rows *w, char *text, size_t size) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  char above[64] = "";
  for (long p = 0; p < w->particle_count; p++) {
    double at[3];
    rows_place(w, w->particle_site[p], at);
    for (int c = 0; c < 3; c++) {
      low[c] = pl_fmin(low[c], at[c]);
      high[c] = pl_fmax(high[c], at[c]);
    }
  }
  if (w->dimensions == 3)
    snprintf(above, sizeof above, ", z = %.6g .. %.6g mm", 1e3 * low[2], 1e3 * high[2]);
  snprintf(text, size, "x = %.6g .. %.6g mm, y = %.6g .. %.6g mm%s", 1e3 * low[0], 1e3 * high[0],
           1e3 * low[1], 1e3 * high[1], above);
}

/* Of the shape; how far it is from it, and [3] where it stands. Infinite where no particle is. */
static double nearest_to(const deck_shape *shape, const rows *w, double nearest[3]) {
  double best = INFINITY;
  for (long p = 0; p < w->particle_count; p++) {
    double here[3] = {0, 0, 0};
    rows_place(w, w->particle_site[p], here);
    const double distance = shape_distance(shape, here);
    if (!(distance < best)) continue;
    best = distance;
    memcpy(nearest, here, sizeof here);
  }
  return best;
}

/* A point says how far away the nearest particle is, other shapes where the body is, too: they may
   lie in it between particles. */
static void hint_nearest(const char *thing, const char *lattice, const deck_shape *shape,
                         const rows *w, diagnostics *d) {
  double at[3] = {0, 0, 0};
  char text[ROWS_PLACE_TEXT], extent[192];
  const double distance = nearest_to(shape, w, at);
  const char *nearest = rows_place_text(w->dimensions, at, text);
  extent_text(w, extent, sizeof extent);
  if (shape->kind == SHAPE_POINT)
    diag_hint(d, "the nearest %s stands %.4g mm away at %s; `within` says how far is near enough",
              thing, 1e3 * distance, nearest);
  else if (isfinite(distance))
    diag_hint(d, "the %ss of `%s` lie in %s; the nearest stands at %s", thing, lattice, extent,
              nearest);
  else
    diag_hint(d, "the %ss of `%s` lie in %s", thing, lattice, extent);
}

static void report_empty(const deck *k, const char *lattice, const deck_region *region,
                         const rows *w, diagnostics *d) {
  const int number = deck_find_lattice(k, lattice);
  const char *thing = number < 0 ? "particle" : deck_particle_word(&k->lattices[number]);
  diag_report(d, DIAG_EMPTY_REGION, region->item.where, "region `%s` holds no %s", region->name,
              thing);
  hint_nearest(thing, lattice, &region->shape, w, d);
}

bool *regions_used(const deck *k) {
  bool *used = must_calloc((size_t)k->region_count + 1, sizeof *used);
#define USED(list, member)                                                                         \
  for (int i = 0; i < k->list##_count; i++) {                                                      \
    const char *name = k->list##s[i].member;                                                       \
    const int region = name ? deck_find_region(k, name) : -1;                                      \
    if (region >= 0) used[region] = true;                                                          \
  }
  USED(material, region)
  USED(material, between[0])
  USED(material, between[1])
  USED(point_mass, region)
  USED(support, region)
  USED(drive, region)
  USED(force, region)
  USED(end_moment, region)
  USED(protect, region)
  USED(initial_velocity, region)
  USED(initial_displacement, region)
  USED(monitor, region)
  USED(monitor, between[0])
  USED(monitor, between[1])
  USED(force, edge)
#undef USED
  return used;
}

region_sites *regions_select(const deck *k, const char *lattice, const rows *w, diagnostics *d) {
  bool *used = regions_used(k);
  region_sites *regions = must_calloc((size_t)k->region_count + 1, sizeof *regions);
  for (int r = 0; r < k->region_count; r++) {
    const deck_region *region = &k->regions[r];
    regions[r].here = region->lattice && strcmp(region->lattice, lattice) == 0;
    if (!regions[r].here) continue;
    regions[r].count = rows_select(w, &region->shape, &regions[r].particles);
    if (regions[r].count == 0)
      report_empty(k, lattice, region, w, d);
    else if (!deck_lacks(k, NULL) && !used[r] && !region->group)
      diag_report(d, DIAG_DECK_WARNING, region->item.where, "region `%s` is never used",
                  region->name);
  }
  free(used);
  return regions;
}

void regions_free(const deck *k, region_sites *regions) {
  for (int r = 0; r < k->region_count; r++)
    free(regions[r].particles);
  free(regions);
}
