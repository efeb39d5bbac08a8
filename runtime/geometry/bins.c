#include "runtime/geometry/bins.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

#define MOST_BOXES_PER_POINT 4.0

static int ascending(const void *p, const void *q) {
  const double a = *(const double *)p, b = *(const double *)q;
  return (a > b) - (a < b);
}

/* Samples tell where nearly all are; a tenth more at either end loses no one who belongs to them. */
void bins_range(const double *x, long count, double range[2]) {
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

static void find_box(bins *b, double *const at[3], long points, double size) {
  double extent[3] = {0, 0, 0}, range[2], boxes;
  for (int c = 0; c < b->dimensions; c++) {
    bins_range(at[c], points, range);
    b->lower[c] = range[0];
    extent[c] = range[1] - range[0];
  }
  for (b->size = size;; b->size *= 1.25) {
    boxes = 1;
    for (int c = 0; c < 3; c++)
      boxes *= floor(extent[c] / b->size) + 1;
    if (boxes <= MOST_BOXES_PER_POINT * (double)points + 64) break;
  }
  for (int c = 0; c < 3; c++)
    b->count[c] = (int)floor(extent[c] / b->size) + 1;
}

static int64_t number_of(const bins *b, const int box[3]) {
  return ((int64_t)box[2] * b->count[1] + box[1]) * b->count[0] + box[0];
}

void bins_box(const bins *b, const double at[3], int box[3]) {
  box[2] = 0;
  for (int c = 0; c < b->dimensions; c++) {
    const double place = floor((at[c] - b->lower[c]) / b->size);
    box[c] = (int)pl_fmin(pl_fmax(place, 0), b->count[c] - 1);
  }
}

static int64_t box_of_point(const bins *b, double *const at[3], long k) {
  const double p[3] = {at[0][k], at[1][k], b->dimensions == 3 ? at[2][k] : 0};
  int box[3];
  bins_box(b, p, box);
  return number_of(b, box);
}

void bins_begin(bins *b, int dimensions, double *const at[3], long points, double size) {
  *b = (bins){.dimensions = dimensions};
  find_box(b, at, points, size);
  const int64_t boxes = (int64_t)b->count[0] * b->count[1] * b->count[2];
  b->first = must_calloc((size_t)boxes + 2, sizeof *b->first);
  b->point = must_alloc(((size_t)points + 1) * sizeof *b->point);
  for (long k = 0; k < points; k++)
    b->first[box_of_point(b, at, k) + 2]++;
  for (int64_t n = 2; n < boxes + 2; n++)
    b->first[n] += b->first[n - 1];
  for (long k = 0; k < points; k++)
    b->point[b->first[box_of_point(b, at, k) + 1]++] = k;
}

void bins_end(bins *b) {
  free(b->first);
  free(b->point);
}

bool bins_points(const bins *b, const int box[3], int64_t *from, int64_t *to) {
  for (int c = 0; c < 3; c++)
    if (box[c] < 0 || box[c] >= b->count[c]) return false;
  const int64_t n = number_of(b, box);
  *from = b->first[n];
  *to = b->first[n + 1];
  return true;
}
