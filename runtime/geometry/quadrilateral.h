/* A quadrilateral as the picture of the unit square under the bilinear map

     x(u, v) = (1 - u)(1 - v) c_0 + u (1 - v) c_1 + u v c_2 + (1 - u) v c_3,   0 <= u, v <= 1. */
#ifndef PERILAT_RUNTIME_QUADRILATERAL_H
#define PERILAT_RUNTIME_QUADRILATERAL_H

/* m^2: the map's Jacobian at corner k; all four are positive where the quadrilateral is convex and
   its corners stand counter-clockwise. */
double quadrilateral_turn(const double corners[4][2], int k);
double quadrilateral_area(const double corners[4][2]); /* m^2 */
void quadrilateral_box(const double corners[4][2], double lower[2], double upper[2]);

/* slope[i][k] = d x_i/d u_k, m. */
void quadrilateral_map(const double corners[4][2], const double u[2], double at[2],
                       double slope[2][2]);
/* The inverse, of a convex one: places outside have values outside of 0 .. 1. */
void quadrilateral_unmap(const double corners[4][2], const double at[2], double u[2]);

static inline double quadrilateral_jacobian(double slope[2][2]) {
  return slope[0][0] * slope[1][1] - slope[0][1] * slope[1][0];
}

#endif
