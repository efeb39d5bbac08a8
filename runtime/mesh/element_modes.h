/* What the points of a bilinear element do together.

   Mean dilatation (B-bar, Hughes 1980): the change of volume of every point is the cell's mean, so
   that elements with 2 x 2 points do not lock where it is 0 at all of them. With
   theta = eps_xx + eps_yy

     eps_xx, eps_yy += (mean theta - theta)/2,   eps_zz stays what the setting says.

   Hourglass modes (Flanagan and Belytschko 1981): with one point an element has two motions without
   strain, u_q = h_q = 1, -1, 1, -1 around it along x and along y. Along

     gamma_q = (h_q - sum_p h_p x_p . grad N_q)/4,

   which no linear field has, it resists with C gamma_q sum_p gamma_p u_p, where C is `hourglass` of
   4 t A D sum_q |grad N_q|^2, so much of the stiffness that the element has along x and y. D is
   that of a strip that is free across, so that it stays where the law hardly changes its volume.
   These are the motions by which an element bends: with 1/6 a square one bends as it should. */
#ifndef PERILAT_RUNTIME_ELEMENT_MODES_H
#define PERILAT_RUNTIME_ELEMENT_MODES_H

#include "runtime/mesh/integration_points.h"
#include "runtime/mesh/mesh.h"
#include "runtime/mesh/shape_functions.h"

/* Whether the cell is a quadrilateral with 2 x 2 points, whose dilatation is the mean. Triangles
   are never so: with one point they have one dilatation anyhow, with three they do not lock. */
static inline bool element_takes_mean(const mesh *m, int cell) {
  return m->mean_dilatation[cell] && m->cell[cell] == CELL_ELEMENT && m->element_gauss[cell] == 2 &&
         (!m->lists || m->lists->nodes[cell] == 4);
}
/* The mean over the points of such a cell of the gradients of its nodes' functions, 1/m, in the
   order of these at every point. */
void element_mean_gradient(const mesh *m, const integration_points *p, int cell,
                           double mean[ELEMENT_MOST_NODES][2]);
/* Strains xx, yy, xy (of engineers) of a point with it by the motions of the nodes, x and y in
   turn. */
void element_mean_strains(const point_shape *s, const double mean[ELEMENT_MOST_NODES][2],
                          double B[3][2 * ELEMENT_MOST_NODES]);

/* gamma of a quadrilateral's nodes, in a grid by the order of mesh_corners, in lists as they stand
   there, and C/(t D), 1; 0 where nothing resists such motions. */
double element_hourglass(const mesh *m, int cell, double gamma[4]);
/* D of a tangent xx, yy, xy by xx, yy, xy, Pa: the larger one of both axes. */
double element_strip_stiffness(const double tangent[3][3]);

#endif
