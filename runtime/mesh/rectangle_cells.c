#include "runtime/mesh/rectangle_cells.h"

#include <math.h>

#include "runtime/base/lane_sum.h"
#include "runtime/kernel.h"

enum { LOW_LEFT, LOW_RIGHT, HIGH_LEFT, HIGH_RIGHT, CORNERS };

/* --- slopes ----------------------------------------------------------------------------------- */

static bool alike(double a, double b, double least) {
  return fabs(a - b) <= least;
}

bool rectangle_slopes_find(pl_rectangle *r, const double slope[4][4][2], double least) {
  *r = (pl_rectangle){.x = {{slope[LOW_LEFT][LOW_RIGHT][0], slope[LOW_LEFT][HIGH_RIGHT][0]},
                            {slope[HIGH_LEFT][LOW_RIGHT][0], slope[HIGH_LEFT][HIGH_RIGHT][0]}},
                      .y = {{slope[LOW_LEFT][HIGH_LEFT][1], slope[LOW_LEFT][HIGH_RIGHT][1]},
                            {slope[LOW_RIGHT][HIGH_LEFT][1], slope[LOW_RIGHT][HIGH_RIGHT][1]}}};
  for (int point = 0; point < CORNERS; point++)
    for (int node = 0; node < CORNERS; node++) {
      const int right = node % 2, high = node / 2;
      const double x = r->x[point / 2][high], y = r->y[point % 2][right];
      if (!alike(slope[point][node][0], right ? x : -x, least) ||
          !alike(slope[point][node][1], high ? y : -y, least))
        return false;
    }
  return true;
}

pl_rectangle rectangle_slopes_times(const pl_rectangle *r, double volume) {
  pl_rectangle out;
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++) {
      out.x[a][b] = volume * r->x[a][b];
      out.y[a][b] = volume * r->y[a][b];
    }
  return out;
}

/* --- cells ------------------------------------------------------------------------------------ */

void rectangle_cells_strain(const pl_rectangle *r, const double *const u[2], long stride,
                            double *const strain[3]) {
  const double *x = u[0], *y = u[1];
  double *xx = strain[0], *yy = strain[1], *xy = strain[2];
  const pl_rectangle slopes = *r;
  INDEPENDENT
  for (long low = 0; low < PL_LANES; low++) {
    const long high = low + stride;
    double here[3][CORNERS];
    pl_rectangle_strain(&slopes, (const double[]){x[low], x[low + 1], x[high], x[high + 1]},
                        (const double[]){y[low], y[low + 1], y[high], y[high + 1]}, here);
    PL_UNROLL_4
    for (int k = 0; k < CORNERS; k++) {
      xx[k * PL_LANES + low] = here[0][k];
      yy[k * PL_LANES + low] = here[1][k];
      xy[k * PL_LANES + low] = here[2][k];
    }
  }
}

void rectangle_cells_push(const pl_rectangle *r, int groups, const double *const stress[3],
                          double *const pushed[RECTANGLE_PUSHES]) {
  const double *xx = stress[0], *yy = stress[1], *xy = stress[2];
  const pl_rectangle slopes = *r;
  for (long first = 0; first < (long)groups * PL_LANES; first += PL_LANES) {
    INDEPENDENT
    for (long lane = 0; lane < PL_LANES; lane++) {
      double here[3][CORNERS], force[2][CORNERS];
      PL_UNROLL_4
      for (int k = 0; k < CORNERS; k++) {
        const long q = CORNERS * first + k * PL_LANES + lane;
        here[0][k] = xx[q];
        here[1][k] = yy[q];
        here[2][k] = xy[q];
      }
      pl_rectangle_push(&slopes, here[0], here[2], force[0]);
      pl_rectangle_push(&slopes, here[2], here[1], force[1]);
      PL_UNROLL_4
      for (int k = 0; k < CORNERS; k++) {
        pushed[k][first + lane] = force[0][k];
        pushed[CORNERS + k][first + lane] = force[1][k];
      }
    }
  }
}

/* A node has a cell to its left and one to its right. */
static void gather_row(int cells, const double *left_node, const double *right_node,
                       double *force) {
  force[0] += left_node[0];
  INDEPENDENT
  for (long n = 1; n < cells; n++)
    force[n] += left_node[n] + right_node[n - 1];
  force[cells] += right_node[cells - 1];
}

void rectangle_cells_gather(int cells, double *const pushed[RECTANGLE_PUSHES],
                            double *const force[2], long stride) {
  for (int d = 0; d < 2; d++) {
    double *const *of = pushed + d * CORNERS;
    gather_row(cells, of[LOW_LEFT], of[LOW_RIGHT], force[d]);
    gather_row(cells, of[HIGH_LEFT], of[HIGH_RIGHT], force[d] + stride);
  }
}
