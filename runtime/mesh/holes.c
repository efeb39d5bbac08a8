#include "runtime/mesh/holes.h"

#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

/* A way around a hole that is longer by less hides nothing: around a round outline and a corner
   nodes act as they would without the hole, and functions have no jumps there. */
static const double LONGER = 1.5;

void holes_open(mesh_holes *h) {
  *h = (mesh_holes){.count = 0};
}

void holes_close(mesh_holes *h) {
  free(h->items);
  holes_open(h);
}

void holes_add(mesh_holes *h, const deck_shape *shape) {
  h->items = must_realloc(h->items, ((size_t)h->count + 1) * sizeof *h->items);
  mesh_hole *one = &h->items[h->count++];
  one->shape = *shape;
  shape_box(shape, one->lower, one->upper);
}

static bool meets_box(const mesh_hole *h, const double lower[2], const double upper[2]) {
  return lower[0] <= h->upper[0] && upper[0] >= h->lower[0] && lower[1] <= h->upper[1] &&
         upper[1] >= h->lower[1];
}

bool holes_meet_box(const mesh_holes *h, const double lower[2], const double upper[2]) {
  for (int n = 0; n < h->count; n++)
    if (meets_box(&h->items[n], lower, upper)) return true;
  return false;
}

bool holes_near(const mesh_holes *h, const double at[2], double distance) {
  const double reach = pl_max(distance, 0), lower[2] = {at[0] - reach, at[1] - reach},
               upper[2] = {at[0] + reach, at[1] + reach};
  for (int n = 0; n < h->count; n++)
    if (meets_box(&h->items[n], lower, upper) && shape_contains(&h->items[n].shape, at, distance))
      return true;
  return false;
}

bool holes_hold(const mesh_holes *h, const double at[2]) {
  return holes_near(h, at, -h->tolerance);
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static int cuts_of(const mesh_hole *items, int hole_count, const double a[2], const double b[2],
                   double **u) {
  const double lower[2] = {pl_min(a[0], b[0]), pl_min(a[1], b[1])},
               upper[2] = {pl_max(a[0], b[0]), pl_max(a[1], b[1])};
  int count = 2, room = 32;
  double *all = must_alloc((size_t)room * sizeof *all);
  all[0] = 0;
  all[1] = 1;
  for (int n = 0; n < hole_count; n++) {
    if (!meets_box(&items[n], lower, upper)) continue;
    int more = shape_cuts(&items[n].shape, a, b, all + count, room - count);
    if (more > room - count) {
      room = 2 * (count + more);
      all = must_realloc(all, (size_t)room * sizeof *all);
      more = shape_cuts(&items[n].shape, a, b, all + count, room - count);
    }
    count += more;
  }
  qsort(all, (size_t)count, sizeof *all, ascending);
  *u = all;
  return count;
}

int holes_cuts(const mesh_holes *h, const double a[2], const double b[2], double **u) {
  return cuts_of(h->items, h->count, a, b, u);
}

static void between(const double a[2], const double b[2], double u, double at[2]) {
  for (int d = 0; d < 2; d++)
    at[d] = a[d] + u * (b[d] - a[d]);
}

/* The line goes through the hole, and around it the way is longer. */
static bool hides(const mesh_hole *h, const double a[2], const double b[2], double tolerance) {
  double *u, p[2], q[2], middle[2];
  if (!shape_crossed(&h->shape, a, b, tolerance)) return false;
  const int count = cuts_of(h, 1, a, b, &u);
  bool hidden = false;
  for (int k = 0; k + 1 < count && !hidden; k++) {
    between(a, b, u[k], p);
    between(a, b, u[k + 1], q);
    between(a, b, 0.5 * (u[k] + u[k + 1]), middle);
    hidden = shape_contains(&h->shape, middle, -tolerance) &&
             shape_way(&h->shape, p, q) > LONGER * pl_hypot(q[0] - p[0], q[1] - p[1]);
  }
  free(u);
  return hidden;
}

bool holes_hide(const mesh_holes *h, const double at[2], const double node[2]) {
  const double lower[2] = {pl_min(at[0], node[0]), pl_min(at[1], node[1])},
               upper[2] = {pl_max(at[0], node[0]), pl_max(at[1], node[1])};
  for (int n = 0; n < h->count; n++)
    if (meets_box(&h->items[n], lower, upper) && hides(&h->items[n], at, node, h->tolerance))
      return true;
  return false;
}

double holes_until(const mesh_holes *h, const double a[2], const double b[2]) {
  double *u, met = 1;
  const int count = h->count > 0 ? holes_cuts(h, a, b, &u) : 0;
  for (int k = 0; k + 1 < count && met == 1; k++) {
    double middle[2];
    between(a, b, 0.5 * (u[k] + u[k + 1]), middle);
    if (holes_hold(h, middle)) met = u[k];
  }
  if (count > 0) free(u);
  return met;
}

bool holes_beyond(const mesh_holes *h, const double from[2], const double at[2], double middle[2]) {
  const double way = pl_hypot(at[0] - from[0], at[1] - from[1]);
  double reach = 0, *u, to[2], end = 0;
  for (int n = 0; n < h->count; n++)
    reach +=
        h->items[n].upper[0] - h->items[n].lower[0] + h->items[n].upper[1] - h->items[n].lower[1];
  if (!(way > 0 && reach > 0)) return false;
  between(from, at, 1 + reach / way, to);
  const int count = holes_cuts(h, at, to, &u);
  for (int k = 0; k + 1 < count; k++) {
    between(at, to, 0.5 * (u[k] + u[k + 1]), middle);
    if ((u[k + 1] - u[k]) * reach <= h->tolerance) continue;
    if (!holes_hold(h, middle)) break;
    end = u[k + 1];
  }
  free(u);
  between(at, to, 0.5 * end, middle);
  return end > 0;
}
