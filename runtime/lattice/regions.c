#include "runtime/lattice/regions.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/geometry/gmsh_mesh.h"
#include "runtime/lattice/rows_select.h"

/* A point says how far away the nearest particle is, other shapes where the body is. */
static void hint_nearest(const char *thing, const double at[3], const rows *w, diagnostics *d) {
  double best = INFINITY, nearest[3] = {0, 0, 0};
  char text[ROWS_PLACE_TEXT];
  for (long p = 0; p < w->particle_count; p++) {
    double here[3];
    rows_place(w, w->particle_site[p], here);
    const double distance = bravais_distance(here, at);
    if (distance >= best) continue;
    best = distance;
    memcpy(nearest, here, sizeof nearest);
  }
  diag_hint(d, "the nearest %s stands %.4g mm away at %s; `within` says how far is near enough",
            thing, 1e3 * best, rows_place_text(w->dimensions, nearest, text));
}

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

/* How far a box is from a place along each axis, squared: 0 within it. */
static double beyond(const double lower[3], const double upper[3], const double at[3]) {
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    const double out = pl_fmax(pl_fmax(lower[c] - at[c], at[c] - upper[c]), 0);
    sum += out * out;
  }
  return sum;
}

/* Next to the shape's box; [3] their place. False where no particle is. */
static bool nearest_to(const deck_shape *shape, const rows *w, double nearest[3]) {
  double lower[3], upper[3], best = INFINITY;
  shape_box(shape, lower, upper);
  for (long p = 0; p < w->particle_count; p++) {
    double here[3] = {0, 0, 0};
    rows_place(w, w->particle_site[p], here);
    const double distance = beyond(lower, upper, here);
    if (!(distance < best)) continue;
    best = distance;
    memcpy(nearest, here, sizeof here);
  }
  return isfinite(best);
}

/* A shape may lie in the body between particles. */
static void hint_shape(const char *thing, const char *lattice, const deck_shape *shape,
                       const rows *w, diagnostics *d) {
  double nearest[3] = {0, 0, 0};
  char text[ROWS_PLACE_TEXT], extent[192];
  extent_text(w, extent, sizeof extent);
  if (nearest_to(shape, w, nearest))
    diag_hint(d, "the %ss of `%s` lie in %s; the nearest stands at %s", thing, lattice, extent,
              rows_place_text(w->dimensions, nearest, text));
  else
    diag_hint(d, "the %ss of `%s` lie in %s", thing, lattice, extent);
}

static void report_empty(const deck *k, const char *lattice, const deck_region *region,
                         const rows *w, diagnostics *d) {
  const int number = deck_find_lattice(k, lattice);
  const bool nodes = number >= 0 && deck_lattice_is_mesh(&k->lattices[number]);
  const char *thing = nodes ? "node" : "particle";
  diag_report(d, DIAG_EMPTY_REGION, region->item.where, "region `%s` holds no %s", region->name,
              thing);
  if (region->shape.kind == SHAPE_POINT)
    hint_nearest(thing, region->shape.at, w, d);
  else
    hint_shape(thing, lattice, &region->shape, w, d);
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
