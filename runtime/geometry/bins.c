#include "runtime/geometry/bins.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

#define MOST_BOXES_PER_POINT 4.0
enum { MOST_ALONG = 1 << 20 /* boxes, along an axis */ };

/* --- boxes ------------------------------------------------------------------------------------ */

int boxes_along(const boxes *b, int axis, double x) {
  return (int)pl_fmin(pl_fmax(floor((x - b->lower[axis]) / b->size), 0), b->count[axis] - 1);
}

void boxes_home(const boxes *b, const double at[3], int box[3]) {
  for (int a = 0; a < 3; a++)
    box[a] = a < b->dimensions ? boxes_along(b, a, at[a]) : 0;
}

int64_t boxes_number(const boxes *b, const int box[3]) {
  for (int a = 0; a < 3; a++)
    if (box[a] < 0 || box[a] >= b->count[a]) return -1;
  return ((int64_t)box[2] * b->count[1] + box[1]) * b->count[0] + box[0];
}

int64_t boxes_all(const boxes *b) {
  return (int64_t)b->count[0] * b->count[1] * b->count[2];
}

static int ascending(const void *p, const void *q) {
  const double a = *(const double *)p, b = *(const double *)q;
  return (a > b) - (a < b);
}

/* From where to where coordinates reach, so that boxes of equal size have about as many each: of
   more than a thousand, the few that lie far from all others are left out. Samples tell where
   nearly all are; a tenth more at either end loses no one who belongs to them. */
static void find_range(const double *x, long count, double range[2]) {
  enum { SAMPLES = 1024, FAR = SAMPLES / 256 };
  double sample[SAMPLES], low = INFINITY, high = -INFINITY;
  for (long k = 0; k < count; k++) {
    low = pl_fmin(low, x[k]);
    high = pl_fmax(high, x[k]);
  }
  range[0] = count > 0 ? low : 0;
  range[1] = count > 0 ? high : 0;
  if (count <= SAMPLES) return;
  for (long k = 0; k < SAMPLES; k++)
    sample[k] = x[k * (count / SAMPLES)];
  qsort(sample, SAMPLES, sizeof *sample, ascending);
  const double within = sample[SAMPLES - 1 - FAR] - sample[FAR];
  if (!(within > 0)) return;
  range[0] = pl_fmax(low, sample[FAR] - 0.1 * within);
  range[1] = pl_fmin(high, sample[SAMPLES - 1 - FAR] + 0.1 * within);
}

static void boxes_of_size(boxes *b, const double extent[3], long points, double size) {
  double all;
  for (b->size = size;; b->size *= 1.25) {
    all = 1;
    for (int a = 0; a < 3; a++)
      all *= floor(extent[a] / b->size) + 1;
    if (all <= MOST_BOXES_PER_POINT * (double)points + 64) break;
  }
  for (int a = 0; a < 3; a++)
    b->count[a] = (int)floor(extent[a] / b->size) + 1;
}

/* A side with so many points a box of the box around nearly all of them (others are in the boxes at
   its sides); axes along which the box is thinner than a box do not count. */
static void boxes_of_few(boxes *b, const double extent[3], long points, double few) {
  bool flat[3] = {false, false, false};
  b->size = 0;
  for (int round = 0; round < 3; round++) {
    double measure = 1;
    int axes = 0;
    for (int a = 0; a < b->dimensions; a++) {
      flat[a] = flat[a] || extent[a] <= b->size;
      if (flat[a]) continue;
      measure *= extent[a];
      axes++;
    }
    if (axes > 0) b->size = pl_pow(measure * few / (double)points, 1.0 / axes);
  }
  if (!(b->size > 0)) b->size = 1; /* all points are one */
  for (int a = 0; a < 3; a++) {
    const double wanted = flat[a] || a >= b->dimensions ? 1 : ceil(extent[a] / b->size);
    b->count[a] = (int)pl_fmin(pl_fmax(wanted, 1), MOST_ALONG);
  }
}

/* --- points ----------------------------------------------------------------------------------- */

static int64_t box_of_point(const boxes *b, const double *const at[3], long k) {
  const double p[3] = {at[0][k], at[1][k], b->dimensions == 3 ? at[2][k] : 0};
  int box[3];
  boxes_home(b, p, box);
  return boxes_number(b, box);
}

static void make_room(int32_t **items, int64_t *room, int64_t count) {
  if (count <= *room) return;
  *items = must_realloc(*items, (size_t)count * sizeof **items);
  *room = count;
}

/* Counted, then sorted in: while that is done first[n + 1] is where the next point of box n
   comes. */
static void sort_points(bins *b, const double *const at[3], long points) {
  const int64_t all = boxes_all(&b->boxes);
  make_room(&b->first, &b->first_room, all + 2);
  make_room(&b->point, &b->point_room, points + 1);
  memset(b->first, 0, (size_t)(all + 2) * sizeof *b->first);
  for (long k = 0; k < points; k++)
    b->first[box_of_point(&b->boxes, at, k) + 2]++;
  for (int64_t n = 2; n < all + 2; n++)
    b->first[n] += b->first[n - 1];
  for (long k = 0; k < points; k++)
    b->point[b->first[box_of_point(&b->boxes, at, k) + 1]++] = (int32_t)k;
}

static void find_extent(boxes *b, const double *const at[3], long points, double extent[3]) {
  double range[2];
  for (int a = 0; a < 3; a++) {
    extent[a] = 0;
    if (a >= b->dimensions) continue;
    find_range(at[a], points, range);
    b->lower[a] = range[0];
    extent[a] = range[1] - range[0];
  }
}

void bins_renew(bins *b, int dimensions, const double *const at[3], long points, double size) {
  double extent[3];
  b->boxes = (boxes){.dimensions = dimensions};
  find_extent(&b->boxes, at, points, extent);
  boxes_of_size(&b->boxes, extent, points, size);
  sort_points(b, at, points);
}

void bins_of_size(bins *b, int dimensions, const double *const at[3], long points, double size) {
  *b = (bins){.first = NULL};
  bins_renew(b, dimensions, at, points, size);
}

void bins_of_few(bins *b, int dimensions, const double *const at[3], long points, double few) {
  double extent[3];
  *b = (bins){.boxes = {.dimensions = dimensions}};
  find_extent(&b->boxes, at, points, extent);
  boxes_of_few(&b->boxes, extent, points, few);
  sort_points(b, at, points);
}

void bins_end(bins *b) {
  free(b->first);
  free(b->point);
}
