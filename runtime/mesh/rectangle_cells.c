#include "runtime/mesh/rectangle_cells.h"

#include <math.h>

#include "runtime/kernel.h"

/* Wider than a register they are taken apart; what has them is inlined, so that no call passes
   them. */
#pragma GCC diagnostic ignored "-Wpsabi"

typedef double lanes
    __attribute__((vector_size(PL_LANES * sizeof(double)), aligned(sizeof(double)), may_alias));

#define INLINE static inline __attribute__((always_inline))

enum { LOW_LEFT, LOW_RIGHT, HIGH_LEFT, HIGH_RIGHT, CORNERS };

/* --- slopes ----------------------------------------------------------------------------------- */

static bool alike(double a, double b, double least) {
  return fabs(a - b) <= least;
}

bool rectangle_slopes_find(rectangle_slopes *r, const double slope[4][4][2], double least) {
  *r = (rectangle_slopes){.x = {{slope[LOW_LEFT][LOW_RIGHT][0], slope[LOW_LEFT][HIGH_RIGHT][0]},
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

/* --- strains ---------------------------------------------------------------------------------- */

INLINE lanes load(const double *at) {
  return *(const lanes *)at;
}

/* Two edges that face each other, or what is at both of two kinds of points. */
typedef struct pair {
  lanes first, second;
} pair;

INLINE pair blend(const double slope[2][2], pair edge) {
  return (pair){slope[0][0] * edge.first + slope[0][1] * edge.second,
                slope[1][0] * edge.first + slope[1][1] * edge.second};
}

void rectangle_cells_strain(const rectangle_slopes *r, const double *const u[2], long stride,
                            double *const strain[3]) {
  pair x[2], y[2];
  for (int d = 0; d < 2; d++) {
    const double *low = u[d], *high = u[d] + stride;
    const lanes left = load(low), right = load(low + 1), up_left = load(high),
                up_right = load(high + 1);
    x[d] = blend(r->x, (pair){right - left, up_right - up_left});
    y[d] = blend(r->y, (pair){up_left - left, up_right - right});
  }
  lanes *xx = (lanes *)strain[0], *yy = (lanes *)strain[1], *xy = (lanes *)strain[2];
  xx[LOW_LEFT] = xx[LOW_RIGHT] = x[0].first;
  xx[HIGH_LEFT] = xx[HIGH_RIGHT] = x[0].second;
  yy[LOW_LEFT] = yy[HIGH_LEFT] = y[1].first;
  yy[LOW_RIGHT] = yy[HIGH_RIGHT] = y[1].second;
  const pair low = {0.5 * x[1].first, 0.5 * x[1].second},
             left = {0.5 * y[0].first, 0.5 * y[0].second};
  xy[LOW_LEFT] = left.first + low.first;
  xy[LOW_RIGHT] = left.second + low.first;
  xy[HIGH_LEFT] = left.first + low.second;
  xy[HIGH_RIGHT] = left.second + low.second;
}

/* --- forces ----------------------------------------------------------------------------------- */

/* What stresses at the points do to the edges: across the lower and the upper one, and across the
   left and the right one. `slope` is times the volume. */
INLINE pair to_edges(const double slope[2][2], lanes first, lanes second) {
  return (pair){slope[0][0] * first + slope[1][0] * second,
                slope[0][1] * first + slope[1][1] * second};
}

INLINE pair across_x(const rectangle_slopes *r, const lanes *s) {
  return to_edges(r->x, s[LOW_LEFT] + s[LOW_RIGHT], s[HIGH_LEFT] + s[HIGH_RIGHT]);
}
INLINE pair across_y(const rectangle_slopes *r, const lanes *s) {
  return to_edges(r->y, s[LOW_LEFT] + s[HIGH_LEFT], s[LOW_RIGHT] + s[HIGH_RIGHT]);
}

/* The last lane of `before`, then all but the last of `x`. */
INLINE lanes shift_in(lanes before, lanes x) {
#if defined(__clang__)
  return __builtin_shufflevector(before, x, 7, 8, 9, 10, 11, 12, 13, 14);
#else
  typedef long long places __attribute__((vector_size(PL_LANES * sizeof(long long))));
  return __builtin_shuffle(before, x, (places){7, 8, 9, 10, 11, 12, 13, 14});
#endif
}
_Static_assert(PL_LANES == 8, "places of lanes");

/* What cells do to their left and right nodes, the lower or the upper ones. */
INLINE pair cut(pair node, int cells) {
  for (int lane = cells; lane < PL_LANES; lane++)
    node.first[lane] = node.second[lane] = 0;
  return node;
}

/* The right nodes of the cells before are left ones of these. */
INLINE void add_to_nodes(double *force, pair node, lanes *before) {
  *(lanes *)force += node.first + shift_in(*before, node.second);
  *before = node.second;
}

INLINE void add_to_rows(double *force, long stride, int cells, pair x, pair y, lanes before[2]) {
  pair low = {-(x.first + y.first), x.first - y.second},
       high = {y.first - x.second, x.second + y.second};
  if (cells < PL_LANES) {
    low = cut(low, cells);
    high = cut(high, cells);
  }
  add_to_nodes(force, low, &before[0]);
  add_to_nodes(force + stride, high, &before[1]);
}

void rectangle_cells_push(const rectangle_slopes *r, int cells, const double *const stress[3],
                          double volume, double *const force[2], long stride) {
  const lanes none = {0};
  lanes before[2][2] = {{none, none}, {none, none}};
  rectangle_slopes scaled;
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++) {
      scaled.x[a][b] = volume * r->x[a][b];
      scaled.y[a][b] = volume * r->y[a][b];
    }
  int first = 0;
  for (; first < cells; first += PL_LANES) {
    const long at = (long)first * CORNERS;
    const lanes *xx = (const lanes *)(stress[0] + at), *yy = (const lanes *)(stress[1] + at),
                *xy = (const lanes *)(stress[2] + at);
    const pair a = across_x(&scaled, xx), b = across_y(&scaled, xy), c = across_x(&scaled, xy),
               d = across_y(&scaled, yy);
    add_to_rows(force[0] + first, stride, cells - first, a, b, before[0]);
    add_to_rows(force[1] + first, stride, cells - first, c, d, before[1]);
  }
  for (int d = 0; d < 2; d++)
    for (int high = 0; high < 2; high++)
      force[d][first + high * stride] += before[d][high][PL_LANES - 1];
}
