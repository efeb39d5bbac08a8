#include "runtime/mesh/gauss_rule.h"

#include <math.h>

#include "dsl/base/elementary.h"

/* Legendre's polynomial of the order and its derivative. */
static double legendre(int order, double x, double *slope) {
  double before = 1, now = x;
  for (int k = 2; k <= order; k++) {
    const double next = ((2 * k - 1) * x * now - (k - 1) * before) / k;
    before = now;
    now = next;
  }
  *slope = order * (x * now - before) / (x * x - 1);
  return now;
}

void gauss_rule(int order, double at[MESH_MOST_GAUSS], double weight[MESH_MOST_GAUSS]) {
  enum { NEWTON_STEPS = 8 };
  for (int k = 0; k < order; k++) {
    double x = -pl_cos(M_PI * (k + 0.75) / (order + 0.5)), slope = 1;
    if (order == 1) x = 0;
    for (int step = 0; step < NEWTON_STEPS && order > 1; step++) {
      const double value = legendre(order, x, &slope);
      x -= value / slope;
    }
    if (order > 1) legendre(order, x, &slope);
    at[k] = x;
    weight[k] = order == 1 ? 2 : 2 / ((1 - x * x) * slope * slope);
  }
}
