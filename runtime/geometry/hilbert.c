#include "runtime/geometry/hilbert.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

uint64_t hilbert_place(int dimensions, const uint32_t cell[3]) {
  uint32_t x[3] = {cell[0], cell[1], dimensions == 3 ? cell[2] : 0};
  for (uint32_t q = UINT32_C(1) << (HILBERT_BITS - 1); q > 1; q >>= 1) /* undo the turns */
    for (int a = 0; a < dimensions; a++) {
      const uint32_t changed = x[a] & q ? q - 1 : 0, swapped = (x[0] ^ x[a]) & (q - 1);
      if (changed) {
        x[0] ^= changed;
      } else {
        x[0] ^= swapped;
        x[a] ^= swapped;
      }
    }
  for (int a = 1; a < dimensions; a++) /* Gray code */
    x[a] ^= x[a - 1];
  uint32_t turned = 0;
  for (uint32_t q = UINT32_C(1) << (HILBERT_BITS - 1); q > 1; q >>= 1)
    if (x[dimensions - 1] & q) turned ^= q - 1;
  uint64_t place = 0;
  for (int bit = HILBERT_BITS - 1; bit >= 0; bit--)
    for (int a = 0; a < dimensions; a++)
      place = place << 1 | ((x[a] ^ turned) >> bit & 1);
  return place;
}

typedef struct placed {
  uint64_t place;
  double at[3];
  int32_t point;
} placed;

static int by_place(const void *p, const void *q) {
  const placed *a = p, *b = q;
  if (a->place != b->place) return a->place < b->place ? -1 : 1;
  for (int c = 0; c < 3; c++)
    if (a->at[c] != b->at[c]) return a->at[c] < b->at[c] ? -1 : 1;
  return (a->point > b->point) - (a->point < b->point);
}

void hilbert_order(const point_cloud *c, int32_t *order) {
  const double last = (double)((UINT32_C(1) << HILBERT_BITS) - 1);
  double low[3] = {0, 0, 0}, side = 0;
  for (int a = 0; a < c->dimensions; a++) {
    double high = -INFINITY;
    low[a] = INFINITY;
    for (long p = 0; p < c->count; p++) {
      low[a] = pl_fmin(low[a], c->at[a][p]);
      high = pl_fmax(high, c->at[a][p]);
    }
    side = pl_fmax(side, high - low[a]);
  }
  placed *all = must_calloc((size_t)c->count + 1, sizeof *all);
  for (long p = 0; p < c->count; p++) {
    uint32_t cell[3] = {0, 0, 0};
    all[p].point = (int32_t)p;
    for (int a = 0; a < c->dimensions; a++) {
      all[p].at[a] = c->at[a][p];
      if (side > 0) cell[a] = (uint32_t)pl_fmin((c->at[a][p] - low[a]) / side * last, last);
    }
    all[p].place = hilbert_place(c->dimensions, cell);
  }
  qsort(all, (size_t)c->count, sizeof *all, by_place);
  for (long p = 0; p < c->count; p++)
    order[p] = all[p].point;
  free(all);
}
