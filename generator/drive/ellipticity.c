#include "generator/drive/ellipticity.h"

#include <math.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "runtime/base/eigen.h"

/* Azimuth and elevation; in the plane the latter is 0. */
typedef struct direction {
  double angle[2];
} direction;

typedef struct searched {
  int dimensions;
  const double (*tangent)[PL_MAX_STRAINS];
} searched;

static void vector_of(const direction *at, double *n) {
  n[0] = pl_cos(at->angle[1]) * pl_cos(at->angle[0]);
  n[1] = pl_cos(at->angle[1]) * pl_sin(at->angle[0]);
  n[2] = pl_sin(at->angle[1]);
}

/* Place of component ij among those of a strain. */
static int component(int dimensions, int i, int j) {
  static const int of_plane[2][2] = {{0, 2}, {2, 1}};
  static const int of_space[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  return dimensions == 2 ? of_plane[i][j] : of_space[i][j];
}

static double acoustic(const searched *s, const double *n, int i, int k) {
  double sum = 0;
  for (int j = 0; j < s->dimensions; j++)
    for (int l = 0; l < s->dimensions; l++)
      sum +=
          n[j] * n[l] * s->tangent[component(s->dimensions, i, j)][component(s->dimensions, k, l)];
  return sum;
}

static ellipticity across(const searched *s, const direction *at) {
  double A[EIGEN_MOST][EIGEN_MOST], value[EIGEN_MOST], vector[EIGEN_MOST][EIGEN_MOST];
  ellipticity e = {.along = {0}};
  vector_of(at, e.normal);
  for (int i = 0; i < s->dimensions; i++)
    for (int k = 0; k < s->dimensions; k++)
      A[i][k] = 0.5 * (acoustic(s, e.normal, i, k) + acoustic(s, e.normal, k, i));
  eigen_symmetric(s->dimensions, A, value, vector);
  int least = 0;
  for (int k = 1; k < s->dimensions; k++)
    if (value[k] < value[least]) least = k;
  e.least = value[least];
  memcpy(e.along, vector[least], (size_t)s->dimensions * sizeof(double));
  return e;
}

/* The best of directions so many to half a turn. */
static direction best_of_many(const searched *s, int parts) {
  direction best = {{0, 0}};
  double least = INFINITY;
  const int high = s->dimensions == 2 ? 0 : parts / 2;
  for (int up = 0; up <= high; up++)
    for (int round = 0; round < (s->dimensions == 2 ? 1 : 2) * parts; round++) {
      const direction at = {{M_PI * round / parts, M_PI * up / parts}};
      const double here = across(s, &at).least;
      if (here >= least) continue;
      least = here;
      best = at;
    }
  return best;
}

/* Goes on to lower neighbours, ever nearer ones. */
static ellipticity descend(const searched *s, direction at, double by) {
  ellipticity best = across(s, &at);
  while (by > 1e-9) {
    direction better = at;
    for (int angle = 0; angle < s->dimensions - 1; angle++)
      for (int side = -1; side <= 1; side += 2) {
        direction there = at;
        there.angle[angle] += side * by;
        const ellipticity here = across(s, &there);
        if (!(here.least < best.least)) continue; /* no number is not nearer */
        best = here;
        better = there;
      }
    if (memcmp(&better, &at, sizeof at) == 0) by *= 0.5;
    at = better;
  }
  return best;
}

ellipticity ellipticity_of(int dimensions, const double tangent[PL_MAX_STRAINS][PL_MAX_STRAINS]) {
  const int parts = dimensions == 2 ? 36 : 18;
  const searched s = {dimensions, tangent};
  return descend(&s, best_of_many(&s, parts), M_PI / parts);
}
