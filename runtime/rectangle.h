/* A bilinear rectangle with 2 x 2 points by the modes of its nodes' motion: both edges stretched
   alike, one more than the other (the hourglass). What these make of strains at the points, and by
   the transpose of stresses there, takes half the multiplications that slopes take:

       high  -1 +1    +1 +1    -1 +1    strain xx at a point = mean_x along_x -+ change_x bend,
       low   -1 +1    -1 -1    +1 -1    - at the low points, + at the high ones; yy alike: + at the
            along_x  along_y    bend    right ones

   Read by the host and, as text, by every kernel, so that both find the same bits. Points and nodes
   stand in the order low left, low right, high left, high right. Local arrays and constant indices
   only: where this is inlined and unrolled, all of it is in registers. */
#ifndef PERILAT_RUNTIME_RECTANGLE_H
#define PERILAT_RUNTIME_RECTANGLE_H

#include "dsl/base/elementary.h"
#include "runtime/kernel.h"

#define PL_RECTANGLE static inline __attribute__((always_inline, unused))

/* Before a loop over the four points, in a loop over rectangles that is done in vectors. */
#if defined(__clang__)
#define PL_UNROLL_4 _Pragma("clang loop unroll(full)")
#else
#define PL_UNROLL_4 _Pragma("GCC unroll 4")
#endif

/* Sizes of N_,x and N_,y at the points, 1/m, or times a volume, m^2: mean + change where the point
   lies on the node's edge of the two along that axis, mean - change on the other; [x, y]. */
typedef struct pl_rectangle {
  double mean[2], change[2];
} pl_rectangle;

/* Of a component of the nodes' motion: m, or m/s. */
typedef struct pl_rectangle_modes {
  double along_x, along_y, bend;
} pl_rectangle_modes;

PL_RECTANGLE pl_rectangle_modes pl_rectangle_modes_of(const double u[4]) {
  const double rising = u[3] - u[0], falling = u[1] - u[2]; /* along the diagonals */
  return (pl_rectangle_modes){rising + falling, rising - falling, (u[3] - u[2]) - (u[1] - u[0])};
}

/* strain xx, yy, xy (of a tensor) from displacements u[nodes] along x and v along y. */
PL_RECTANGLE void pl_rectangle_strain(const pl_rectangle *r, const double u[4], const double v[4],
                                      double strain[3][4]) {
  const pl_rectangle_modes a = pl_rectangle_modes_of(u), b = pl_rectangle_modes_of(v);
  const double xx = r->mean[0] * a.along_x, xx_high = r->change[0] * a.bend,
               yy = r->mean[1] * b.along_y, yy_right = r->change[1] * b.bend;
  const double xy = pl_fma(0.5 * r->mean[1], a.along_y, 0.5 * r->mean[0] * b.along_x),
               xy_right = 0.5 * r->change[1] * a.bend, xy_high = 0.5 * r->change[0] * b.bend;
  const double both = xy_right + xy_high, one = xy_right - xy_high;
  strain[0][0] = strain[0][1] = xx - xx_high;
  strain[0][2] = strain[0][3] = xx + xx_high;
  strain[1][0] = strain[1][2] = yy - yy_right;
  strain[1][1] = strain[1][3] = yy + yy_right;
  strain[2][0] = xy - both;
  strain[2][1] = xy + one;
  strain[2][2] = xy - one;
  strain[2][3] = xy + both;
}

/* Forces of the nodes along an axis, N, from the stress there on faces across x and across y at the
   points: xx and xy along x, xy and yy along y. r: times the volume of a point, m^2. */
PL_RECTANGLE void pl_rectangle_push(const pl_rectangle *r, const double x[4], const double y[4],
                                    double force[4]) {
  const double x_low = x[0] + x[1], x_high = x[2] + x[3], y_left = y[0] + y[2],
               y_right = y[1] + y[3];
  const double along_x = r->mean[0] * (x_low + x_high), along_y = r->mean[1] * (y_left + y_right),
               bend = pl_fma(r->change[0], x_high - x_low, r->change[1] * (y_right - y_left));
  const double rising = along_x + along_y, falling = along_x - along_y;
  force[0] = bend - rising;
  force[1] = falling - bend;
  force[2] = (along_y - along_x) - bend;
  force[3] = rising + bend;
}

/* What a vector of rectangles side by side does to its nodes along an axis, N; [low and high]. In
   front of what they do to their right nodes stands what those of the vector before do. */
typedef struct pl_rectangle_ends {
  double left[2][PL_LANES], right[2][2 * PL_LANES];
} pl_rectangle_ends;

/* before: what the rectangle before the first does to its right nodes. */
PL_RECTANGLE void pl_rectangle_begin(pl_rectangle_ends *e, const double before[2]) {
  e->right[0][PL_LANES - 1] = before[0];
  e->right[1][PL_LANES - 1] = before[1];
}

PL_RECTANGLE void pl_rectangle_keep(pl_rectangle_ends *e, long lane, const double force[4]) {
  e->left[0][lane] = force[0];
  e->right[0][PL_LANES + lane] = force[1];
  e->left[1][lane] = force[2];
  e->right[1][PL_LANES + lane] = force[3];
}

/* In registers: a shifted load would wait for what has just been stored. */
typedef double pl_vector __attribute__((vector_size(8 * PL_LANES), aligned(8), may_alias));
#if defined(__clang__)
#define PL_ONE_LATER(before, v) __builtin_shufflevector(before, v, 7, 8, 9, 10, 11, 12, 13, 14)
#else
typedef long long pl_places __attribute__((vector_size(8 * PL_LANES)));
#define PL_ONE_LATER(before, v)                                                                    \
  __builtin_shuffle(before, v, (pl_places){7, 8, 9, 10, 11, 12, 13, 14})
#endif

/* Forces of the left nodes of the first `cells` rectangles of a vector: of the lower ones, from
   these and from the row below, which is read in `above`; there then stands what these do to the
   upper ones. */
PL_RECTANGLE void pl_rectangle_sum(pl_rectangle_ends *e, long cells, double *force, double *above) {
  if (cells < PL_LANES) {
    for (long n = 0; n < cells; n++) {
      force[n] = (e->left[0][n] + e->right[0][PL_LANES - 1 + n]) + above[n];
      above[n] = e->left[1][n] + e->right[1][PL_LANES - 1 + n];
    }
    e->right[0][PL_LANES - 1] = e->right[0][PL_LANES - 1 + cells];
    e->right[1][PL_LANES - 1] = e->right[1][PL_LANES - 1 + cells];
    return;
  }
  pl_vector sum[2];
  for (int side = 0; side < 2; side++) {
    pl_vector *right = (pl_vector *)e->right[side];
    sum[side] = *(pl_vector *)e->left[side] + PL_ONE_LATER(right[0], right[1]);
    right[0] = right[1];
  }
  *(pl_vector *)force = sum[0] + *(pl_vector *)above;
  *(pl_vector *)above = sum[1];
}

/* after: what the last rectangle does to its right nodes. */
PL_RECTANGLE void pl_rectangle_end(const pl_rectangle_ends *e, double after[2]) {
  after[0] = e->right[0][PL_LANES - 1];
  after[1] = e->right[1][PL_LANES - 1];
}

#endif
