#include "runtime/geometry/quadrilateral.h"

#include <math.h>

#include "dsl/base/elementary.h"

double quadrilateral_turn(const double corners[4][2], int k) {
  const double *at = corners[k], *next = corners[(k + 1) % 4], *last = corners[(k + 3) % 4];
  return (next[0] - at[0]) * (last[1] - at[1]) - (next[1] - at[1]) * (last[0] - at[0]);
}

double quadrilateral_area(const double corners[4][2]) {
  return 0.5 * (quadrilateral_turn(corners, 0) + quadrilateral_turn(corners, 2));
}

void quadrilateral_box(const double corners[4][2], double lower[2], double upper[2]) {
  for (int a = 0; a < 2; a++) {
    lower[a] = upper[a] = corners[0][a];
    for (int k = 1; k < 4; k++) {
      lower[a] = pl_min(lower[a], corners[k][a]);
      upper[a] = pl_max(upper[a], corners[k][a]);
    }
  }
}

void quadrilateral_map(const double c[4][2], const double u[2], double at[2], double slope[2][2]) {
  for (int a = 0; a < 2; a++) {
    const double low = c[1][a] - c[0][a], high = c[2][a] - c[3][a], left = c[3][a] - c[0][a];
    slope[a][0] = low + u[1] * (high - low);
    slope[a][1] = left + u[0] * (high - low);
    at[a] = c[0][a] + u[0] * slope[a][0] + u[1] * left;
  }
}

/* By Newton's method from the middle. */
void quadrilateral_unmap(const double corners[4][2], const double at[2], double u[2]) {
  enum { MOST_STEPS = 30 };
  u[0] = u[1] = 0.5;
  for (int step = 0; step < MOST_STEPS; step++) {
    double here[2], slope[2][2];
    quadrilateral_map(corners, u, here, slope);
    const double turn = quadrilateral_jacobian(slope), x = at[0] - here[0], y = at[1] - here[1];
    if (turn == 0) return;
    const double du = (slope[1][1] * x - slope[0][1] * y) / turn,
                 dv = (slope[0][0] * y - slope[1][0] * x) / turn;
    u[0] += du;
    u[1] += dv;
    if (fabs(du) < 1e-15 && fabs(dv) < 1e-15) return;
  }
}
