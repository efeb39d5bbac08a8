#include "runtime/lattice/rows_select.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/geometry/neighbour_search.h"
#include "runtime/particles/site_marks.h"

static long select_nearest(const rows *w, const deck_shape *shape, int32_t *list) {
  double best = INFINITY;
  for (long p = 0; p < w->particle_count; p++) {
    double at[3];
    rows_place(w, w->particle_site[p], at);
    const double distance = bravais_distance(at, shape->at);
    if (distance >= best - SITE_TIE_TOLERANCE * w->spacing) continue;
    best = distance;
    list[0] = (int32_t)p;
  }
  if (isinf(best)) return 0;
  return best <= site_point_reach(shape, rows_spacing(w, w->particle_site[list[0]])) ? 1 : 0;
}

long rows_select(const rows *w, const deck_shape *shape, int32_t **list) {
  int32_t *chosen = must_alloc((size_t)w->particle_count * sizeof *chosen);
  long count = 0;
  *list = chosen;
  for (; shape->members && count < shape->member_count; count++)
    chosen[count] = shape->members[count];
  if (shape->members) return count;
  if (shape->kind == SHAPE_POINT) return select_nearest(w, shape, chosen);
  for (long p = 0; p < w->particle_count; p++) {
    double at[3];
    rows_place(w, w->particle_site[p], at);
    if (shape_contains(shape, at, SITE_OUTLINE_TOLERANCE * w->spacing))
      chosen[count++] = (int32_t)p;
  }
  return count;
}

void rows_bodies(const rows *w, const deck *k, int lattice, int32_t *body) {
  memset(body, 0, (size_t)w->particle_count * sizeof *body);
  for (int b = k->body_count - 1; b >= 0; b--) { /* the first has the last word */
    if (strcmp(k->bodys[b].lattice, k->lattices[lattice].name) != 0) continue;
    int32_t *list;
    const long count = rows_select(w, &k->bodys[b].shape, &list);
    for (long p = 0; p < count; p++)
      body[list[p]] = b;
    free(list);
  }
}

/* Columns of the row within `reach` (m) of the site: +1 at the first, -1 behind the last. */
static void add_interval(const rows *w, long site, int row, double reach, int32_t *steps) {
  const double *step = w->infinite.step;
  const int own = rows_row(w, site);
  const double across = (row % w->layer_rows - own % w->layer_rows) * step[BRAVAIS_ROW];
  const double above = (row / w->layer_rows - own / w->layer_rows) * step[BRAVAIS_LAYER];
  const double square = across * across + above * above;
  if (square > reach * reach) return;
  const double half = sqrt(reach * reach - square) / step[BRAVAIS_COLUMN];
  const int shift = w->row_class[row + w->margin] - w->row_class[own + w->margin];
  const double middle = (double)(site - rows_start(w, own)) - 0.5 * shift;
  const double first = pl_fmax(ceil(middle - half), 0);
  const double last = pl_fmin(floor(middle + half), (double)w->pitch - 1);
  if (first > last) return;
  steps[rows_start(w, row) + (long)first]++;
  steps[rows_start(w, row) + (long)last + 1]--;
}

static int steps_within(double reach, double step, int most) {
  return step > 0 ? (int)pl_fmin(ceil(reach / step), most) : 0;
}

/* Sites within `reach` of the particles; intervals a row, so that a wide reach costs rows and not
   sites. */
static unsigned char *mark_near(const rows *w, const int32_t *particles, long count, double reach) {
  int32_t *steps = must_calloc((size_t)w->size + 1, sizeof *steps);
  unsigned char *near = must_calloc((size_t)w->size, 1);
  const int rise = steps_within(reach, w->infinite.step[BRAVAIS_ROW], w->layer_rows);
  const int climb =
      steps_within(reach, w->infinite.step[BRAVAIS_LAYER], w->row_count / w->layer_rows);
  for (long p = 0; p < count; p++) {
    const long site = w->particle_site[particles[p]];
    const int own = rows_row(w, site), in_layer = own % w->layer_rows;
    for (int layer = own - in_layer - climb * w->layer_rows;
         layer <= own - in_layer + climb * w->layer_rows; layer += w->layer_rows)
      for (int row = in_layer - rise; row <= in_layer + rise; row++)
        if (row >= 0 && row < w->layer_rows && layer >= 0 && layer + row < w->row_count)
          add_interval(w, site, layer + row, reach, steps);
  }
  int32_t depth = 0;
  for (long site = 0; site < w->size; site++) {
    depth += steps[site];
    near[site] = depth > 0;
  }
  free(steps);
  return near;
}

/* On lists. */
static unsigned char *mark_points_near(const rows *w, const int32_t *particles, long count,
                                       double reach) {
  const point_cloud all = {w->dimensions, w->size, {w->x, w->y, w->z}};
  unsigned char *near = must_calloc((size_t)w->size, 1);
  int32_t *sites = must_alloc(((size_t)count + 1) * sizeof *sites);
  for (long p = 0; p < count; p++)
    sites[p] = w->particle_site[particles[p]];
  points_near(&all, sites, count, reach, near);
  free(sites);
  return near;
}

void rows_protect(rows *w, const int32_t *particles, long count, double radius) {
  const double reach = pl_fmax(radius, 0) + SITE_OUTLINE_TOLERANCE * w->spacing;
  unsigned char *near = w->list ? mark_points_near(w, particles, count, reach)
                                : mark_near(w, particles, count, reach);
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    if (near[site]) w->held[site] = 1;
    for (int k = 0; k < w->directions; k++)
      if (rows_has_bond(w, site, k) && (near[site] || near[rows_partner(w, site, k)]))
        w->held_bonds[site] |= UINT64_C(1) << k;
  }
  free(near);
}
