/* Moving least squares on a regular grid (Lancaster and Salkauskas 1981; Belytschko, Lu and Gu
   1994; Karlsson 2006, 2.2): the functions of nodes I at a point x,

       N_I = w_I p_I.g,   N_I,i = w_I p_I.h_i + w_I,i p_I.g,
       A g = p,   A h_i = p_,i - A_,i g,   A = sum w_I p_I p_I^T,

   with the linear basis shifted to x and scaled, p_I = (1, (x_I - x)/dx, (y_I - y)/dy), and weights
   w = w(r_x) w(r_y), r_x = |x - x_I|/(d_max dx):

       w(r) = 2/3 - 4 r^2 + 4 r^3              r <= 1/2
              4/3 - 4 r + 4 r^2 - (4/3) r^3    up to 1

   whose derivatives carry 1/(d_max dx), which (2.11) and (2.12) as printed lack. N_I(x_I) is not 1:
   nodal values are parameters, and the displacement is sum N_I u_I. */
#ifndef PERILAT_RUNTIME_MOVING_LEAST_SQUARES_H
#define PERILAT_RUNTIME_MOVING_LEAST_SQUARES_H

#include "runtime/mesh/mesh.h"

enum { SHAPE_MOST_NODES = 148 }; /* of a point: supports of 5.5 spacings, and corners of a cell */

typedef struct point_shape {
  int count;
  int node[SHAPE_MOST_NODES];
  double n[SHAPE_MOST_NODES];                        /* 1 */
  double nx[SHAPE_MOST_NODES], ny[SHAPE_MOST_NODES]; /* 1/m */
} point_shape;

/* The functions at a point. Nodes without one (mesh.moving) are left out, and so are those that
   cracks or holes hide; where what is left is too little (fewer than 3 nodes, or a pivot of A below
   1e-9) the point ignores both: false. Where holes leave too few nodes even so, none acts. */
bool moving_least_squares(const mesh *m, const double at[2], point_shape *out);

/* w(r) and dw/dr of the weight above; r >= 0. */
double moving_weight(double r);
double moving_weight_slope(double r);

#endif
