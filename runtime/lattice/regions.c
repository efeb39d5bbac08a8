#include "runtime/lattice/regions.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/geometry/gmsh_mesh.h"
#include "runtime/lattice/rows_select.h"

/* A point says how far away the nearest particle is, other shapes where the body is. */
static void hint_nearest(const double at[3], const rows *w, diagnostics *d) {
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
  diag_hint(d,
            "the nearest particle stands %.4g mm away at %s; `within` says how far is near enough",
            1e3 * best, rows_place_text(w->dimensions, nearest, text));
}

static void hint_extent(const char *lattice, const rows *w, diagnostics *d) {
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
  diag_hint(d, "the particles of `%s` lie in x = %.6g .. %.6g mm, y = %.6g .. %.6g mm%s", lattice,
            1e3 * low[0], 1e3 * high[0], 1e3 * low[1], 1e3 * high[1], above);
}

static void report_empty(const char *lattice, const deck_region *region, const rows *w,
                         diagnostics *d) {
  diag_report(d, DIAG_EMPTY_REGION, region->item.where, "region `%s` holds no particle",
              region->name);
  if (region->shape.kind == SHAPE_POINT)
    hint_nearest(region->shape.at, w, d);
  else
    hint_extent(lattice, w, d);
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
      report_empty(lattice, region, w, d);
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
