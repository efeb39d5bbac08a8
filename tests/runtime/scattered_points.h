/* Points for tests of particles that stand anywhere: drawn, on lattices, in any order. */
#ifndef PERILAT_TESTS_SCATTERED_POINTS_H
#define PERILAT_TESTS_SCATTERED_POINTS_H

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/geometry/neighbour_search.h"

typedef struct test_points {
  point_cloud cloud;
  double *at[3];
} test_points;

static inline uint64_t points_bits(uint64_t *state) { /* xorshift */
  *state ^= *state << 13;
  *state ^= *state >> 7;
  *state ^= *state << 17;
  return *state;
}

/* In 0 to 1. */
static inline double points_draw(uint64_t *state) {
  return (double)(points_bits(state) >> 11) * 0x1p-53;
}

static inline test_points points_new(int dimensions, long count) {
  test_points p = {.cloud = {.dimensions = dimensions, .count = count}};
  for (int a = 0; a < dimensions; a++)
    p.cloud.at[a] = p.at[a] = must_calloc((size_t)count + 1, sizeof(double));
  return p;
}

static inline void points_free(test_points *p) {
  for (int a = 0; a < p->cloud.dimensions; a++)
    free(p->at[a]);
}

/* In a box of these sides. */
static inline test_points points_drawn(int dimensions, long count, const double sides[3],
                                       uint64_t seed) {
  test_points p = points_new(dimensions, count);
  for (long k = 0; k < count; k++)
    for (int a = 0; a < dimensions; a++)
      p.at[a][k] = sides[a] * points_draw(&seed);
  return p;
}

/* Columns times rows of the hexagonal lattice of spacing 1, each moved by up to `shake` along
   either axis. */
static inline test_points points_hexagonal(long columns, long lines, double shake, uint64_t seed) {
  test_points p = points_new(2, columns * lines);
  for (long k = 0; k < p.cloud.count; k++) {
    const long row = k / columns;
    p.at[0][k] =
        (double)(k % columns) + 0.5 * (double)(row % 2) + shake * (2 * points_draw(&seed) - 1);
    p.at[1][k] = (double)row * sqrt(0.75) + shake * (2 * points_draw(&seed) - 1);
  }
  return p;
}

/* A permutation of 0 .. count - 1; malloc'ed. */
static inline int32_t *points_shuffle(long count, uint64_t seed) {
  int32_t *to = must_alloc(((size_t)count + 1) * sizeof *to);
  for (long k = 0; k < count; k++)
    to[k] = (int32_t)k;
  for (long k = count - 1; k > 0; k--) {
    const long other = (long)(points_bits(&seed) % (uint64_t)(k + 1));
    const int32_t kept = to[k];
    to[k] = to[other];
    to[other] = kept;
  }
  return to;
}

/* Point k becomes point to[k]. */
static inline test_points points_renumbered(const test_points *p, const int32_t *to) {
  test_points other = points_new(p->cloud.dimensions, p->cloud.count);
  for (long k = 0; k < p->cloud.count; k++)
    for (int a = 0; a < p->cloud.dimensions; a++)
      other.at[a][to[k]] = p->at[a][k];
  return other;
}

static inline int points_compare(const void *p, const void *q) {
  const point_pair *a = p, *b = q;
  return a->i != b->i ? (a->i > b->i) - (a->i < b->i) : (a->j > b->j) - (a->j < b->j);
}

static inline void points_sort(point_pairs *l) {
  if (l->count) qsort(l->items, (size_t)l->count, sizeof *l->items, points_compare);
}

#endif
