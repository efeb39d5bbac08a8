#include "runtime/mesh/rectangle_cells.h"

#include <math.h>

#include "runtime/base/lane_sum.h"
#include "runtime/kernel.h"

enum { LOW_LEFT, LOW_RIGHT, HIGH_LEFT, HIGH_RIGHT, CORNERS };

/* --- slopes ----------------------------------------------------------------------------------- */

static double sign(bool plus) {
  return plus ? 1 : -1;
}

bool rectangle_slopes_find(pl_rectangle *r, const double slope[4][4][2], double least) {
  for (int d = 0; d < 2; d++) {
    const int across = d == 0 ? HIGH_LEFT : LOW_RIGHT; /* the corner beside, along the other axis */
    const double near = -slope[LOW_LEFT][LOW_LEFT][d], far = -slope[LOW_LEFT][across][d];
    r->mean[d] = 0.5 * (near + far);
    r->change[d] = 0.5 * (near - far);
  }
  for (int point = 0; point < CORNERS; point++)
    for (int node = 0; node < CORNERS; node++) {
      const bool right = node % 2, high = node / 2, point_right = point % 2, point_high = point / 2;
      const double x = r->mean[0] + sign(high == point_high) * r->change[0],
                   y = r->mean[1] + sign(right == point_right) * r->change[1];
      if (!(fabs(slope[point][node][0] - sign(right) * x) <= least) ||
          !(fabs(slope[point][node][1] - sign(high) * y) <= least))
        return false;
    }
  return true;
}

pl_rectangle rectangle_slopes_times(const pl_rectangle *r, double volume) {
  return (pl_rectangle){.mean = {volume * r->mean[0], volume * r->mean[1]},
                        .change = {volume * r->change[0], volume * r->change[1]}};
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

/* --- rows of cells ---------------------------------------------------------------------------- */

static const double NONE = -0.0; /* added to a number it is that number, to the bit */

static void begin_row(rectangle_rows *r) {
  for (int d = 0; d < 2; d++)
    r->right[d][0] = r->right[d][1] = NONE;
}

void rectangle_rows_begin(rectangle_rows *r, int first, int end) {
  for (int d = 0; d < 2; d++)
    for (int n = first; n < end; n++)
      r->above[d][n] = NONE;
  begin_row(r);
}

void rectangle_rows_end(rectangle_rows *r, int node, double *const force[2]) {
  for (int d = 0; d < 2; d++) {
    force[d][0] = r->right[d][0] + r->above[d][node];
    r->above[d][node] = r->right[d][1];
  }
  begin_row(r);
}
