/* A bilinear rectangle with 2 x 2 points by what its edges do: strains at the points are blends of
   differences of displacements along two edges, and forces follow by the transpose. Read by the
   host and, as text, by every kernel, so that both find the same bits. Points and nodes stand in
   the order low left, low right, high left, high right. Local arrays and constant indices only:
   where this is inlined and unrolled, all of it is in registers. */
#ifndef PERILAT_RUNTIME_RECTANGLE_H
#define PERILAT_RUNTIME_RECTANGLE_H

#if defined(__GNUC__)
#define PL_RECTANGLE static inline __attribute__((always_inline, unused))
#else
#define PL_RECTANGLE static inline
#endif

/* Before a loop over the four points, in a loop over rectangles that is done in vectors. */
#if defined(__clang__)
#define PL_UNROLL_4 _Pragma("clang loop unroll(full)")
#else
#define PL_UNROLL_4 _Pragma("GCC unroll 4")
#endif

/* Slopes, 1/m, or times a volume: x[low or high point][lower or upper edge],
   y[left or right point][left or right edge]. */
typedef struct pl_rectangle {
  double x[2][2], y[2][2];
} pl_rectangle;

/* strain xx, yy, xy (of a tensor) from displacements u[nodes] along x and v along y. */
PL_RECTANGLE void pl_rectangle_strain(const pl_rectangle *r, const double u[4], const double v[4],
                                      double strain[3][4]) {
  const double u_low = u[1] - u[0], u_high = u[3] - u[2], u_left = u[2] - u[0],
               u_right = u[3] - u[1], v_low = v[1] - v[0], v_high = v[3] - v[2],
               v_left = v[2] - v[0], v_right = v[3] - v[1];
  const double xx_low = r->x[0][0] * u_low + r->x[0][1] * u_high,
               xx_high = r->x[1][0] * u_low + r->x[1][1] * u_high,
               yy_left = r->y[0][0] * v_left + r->y[0][1] * v_right,
               yy_right = r->y[1][0] * v_left + r->y[1][1] * v_right;
  const double low = 0.5 * (r->x[0][0] * v_low + r->x[0][1] * v_high),
               high = 0.5 * (r->x[1][0] * v_low + r->x[1][1] * v_high),
               left = 0.5 * (r->y[0][0] * u_left + r->y[0][1] * u_right),
               right = 0.5 * (r->y[1][0] * u_left + r->y[1][1] * u_right);
  strain[0][0] = strain[0][1] = xx_low;
  strain[0][2] = strain[0][3] = xx_high;
  strain[1][0] = strain[1][2] = yy_left;
  strain[1][1] = strain[1][3] = yy_right;
  strain[2][0] = left + low;
  strain[2][1] = right + low;
  strain[2][2] = left + high;
  strain[2][3] = right + high;
}

/* Forces of the nodes along an axis, N, from the stress there on faces across x and across y at the
   points: xx and xy along x, xy and yy along y. r: slopes times the volume of a point, m^2. */
PL_RECTANGLE void pl_rectangle_push(const pl_rectangle *r, const double x[4], const double y[4],
                                    double force[4]) {
  const double x_low = x[0] + x[1], x_high = x[2] + x[3], y_left = y[0] + y[2],
               y_right = y[1] + y[3];
  const double low = r->x[0][0] * x_low + r->x[1][0] * x_high,
               high = r->x[0][1] * x_low + r->x[1][1] * x_high,
               left = r->y[0][0] * y_left + r->y[1][0] * y_right,
               right = r->y[0][1] * y_left + r->y[1][1] * y_right;
  force[0] = -(low + left);
  force[1] = low - right;
  force[2] = left - high;
  force[3] = high + right;
}

#endif
