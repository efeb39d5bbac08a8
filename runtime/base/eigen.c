#include "runtime/base/eigen.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { MOST_SWEEPS = 50 }; /* six or seven are needed */

static double size_of(int order, double a[EIGEN_MOST][EIGEN_MOST]) {
  double square = 0;
  for (int p = 0; p < order; p++)
    for (int q = 0; q < order; q++)
      square += a[p][q] * a[p][q];
  return sqrt(square);
}

/* The rotation by the smaller of the two angles that make a[p][q] vanish, of rows, columns and
   vectors. */
static void rotate(int order, double a[EIGEN_MOST][EIGEN_MOST],
                   double vectors[EIGEN_MOST][EIGEN_MOST], int p, int q) {
  const double ratio = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const double t = (ratio < 0 ? -1 : 1) / (fabs(ratio) + sqrt(ratio * ratio + 1));
  const double c = 1 / sqrt(t * t + 1), s = t * c, moved = t * a[p][q];
  a[p][p] -= moved;
  a[q][q] += moved;
  a[p][q] = a[q][p] = 0;
  for (int k = 0; k < order; k++) {
    const double x = vectors[p][k], y = vectors[q][k];
    vectors[p][k] = c * x - s * y;
    vectors[q][k] = s * x + c * y;
    if (k == p || k == q) continue;
    const double kp = a[k][p], kq = a[k][q];
    a[k][p] = a[p][k] = c * kp - s * kq;
    a[k][q] = a[q][k] = s * kp + c * kq;
  }
}

void eigen_symmetric(int order, double a[EIGEN_MOST][EIGEN_MOST], double values[EIGEN_MOST],
                     double vectors[EIGEN_MOST][EIGEN_MOST]) {
  const double nothing = 0x1p-60 * size_of(order, a);
  bool done = false;
  memset(vectors, 0, EIGEN_MOST * sizeof *vectors);
  for (int p = 0; p < order; p++)
    vectors[p][p] = 1;
  for (int sweep = 0; sweep < MOST_SWEEPS && !done; sweep++) {
    done = true;
    for (int p = 0; p < order; p++)
      for (int q = p + 1; q < order; q++) {
        if (!(fabs(a[p][q]) > nothing)) continue;
        rotate(order, a, vectors, p, q);
        done = false;
      }
  }
  for (int p = 0; p < order; p++)
    values[p] = a[p][p];
}
