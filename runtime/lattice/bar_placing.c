#include "runtime/lattice/bar_placing.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/geometry/bins.h"

typedef struct places { /* of a body's particles */
  double *at[3];
  bins bins;
} places;

static places places_of(const rows *w) {
  places p = {.at = {NULL}};
  for (int a = 0; a < w->dimensions; a++)
    p.at[a] = must_alloc(((size_t)w->particle_count + 1) * sizeof(double));
  for (long n = 0; n < w->particle_count; n++) {
    double at[3];
    rows_place(w, w->particle_site[n], at);
    for (int a = 0; a < w->dimensions; a++)
      p.at[a][n] = at[a];
  }
  bins_of_size(&p.bins, w->dimensions, (const double *const *)p.at, w->particle_count, w->spacing);
  return p;
}

static void places_free(places *p) {
  bins_end(&p->bins);
  for (int a = 0; a < 3; a++)
    free(p->at[a]);
}

static double nearest_in(const places *p, int64_t box, const double at[3]) {
  double nearest = INFINITY;
  if (box < 0) return nearest;
  for (int32_t k = p->bins.first[box]; k < p->bins.first[box + 1]; k++) {
    double square = 0;
    for (int a = 0; a < p->bins.boxes.dimensions; a++) {
      const double way = p->at[a][p->bins.point[k]] - at[a];
      square += way * way;
    }
    nearest = pl_fmin(nearest, square);
  }
  return nearest;
}

/* To the nearest, where that is within the size of a box; else more than that. */
static double distance_to(const places *p, const double at[3]) {
  const int layers = p->bins.boxes.dimensions == 3;
  int home[3];
  double nearest = INFINITY;
  boxes_home(&p->bins.boxes, at, home);
  for (int z = -layers; z <= layers; z++)
    for (int y = -1; y <= 1; y++)
      for (int x = -1; x <= 1; x++) {
        const int box[3] = {home[0] + x, home[1] + y, home[2] + z};
        nearest = pl_fmin(nearest, nearest_in(p, boxes_number(&p->bins.boxes, box), at));
      }
  return sqrt(nearest);
}

bar_placing bar_placing_in(const rows *bar, const rows *body) {
  const double rounding = 1e-6 * body->spacing;
  bar_placing found = {.least = INFINITY};
  places p = places_of(body);
  for (long n = 0; n < bar->particle_count; n++) {
    double at[3];
    rows_place(bar, bar->particle_site[n], at);
    const double distance = distance_to(&p, at);
    if (!(distance <= body->spacing + rounding)) continue;
    found.inside++;
    found.least = pl_fmin(found.least, distance);
    found.most = pl_fmax(found.most, distance);
    found.mean += distance;
  }
  if (found.inside) found.mean /= (double)found.inside;
  places_free(&p);
  return found;
}
