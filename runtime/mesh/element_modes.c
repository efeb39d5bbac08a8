#include "runtime/mesh/element_modes.h"

#include <string.h>

#include "dsl/base/elementary.h"

/* Of any mesh in the order of mesh_corners. */
static void corners_of(const mesh *m, int cell, double at[4][2]) {
  int node[ELEMENT_MOST_NODES];
  mesh_cell_nodes(m, cell, node);
  for (int q = 0; q < 4; q++)
    mesh_place(m, node[mesh_corner_around(q)], at[q]);
}

/* Corners in the order of mesh_corners. */
static double of_quadrilateral(double at[4][2], double mean[4][2]) {
  const double x30 = at[3][0] - at[0][0], y30 = at[3][1] - at[0][1], x21 = at[2][0] - at[1][0],
               y21 = at[2][1] - at[1][1], area = 0.5 * (x30 * y21 - x21 * y30);
  const double first[2] = {-y21 / (2 * area), x21 / (2 * area)},
               second[2] = {y30 / (2 * area), -x30 / (2 * area)};
  for (int a = 0; a < 2; a++) {
    mean[0][a] = first[a];
    mean[3][a] = -first[a];
    mean[1][a] = second[a];
    mean[2][a] = -second[a];
  }
  return area;
}

/* At the point of an element with one; returns the area, m^2. */
static double middle_gradient(const mesh *m, int cell, double mean[4][2]) {
  double at[4][2];
  if (m->mapped || m->lists) {
    corners_of(m, cell, at);
    return of_quadrilateral(at, mean);
  }
  for (int q = 0; q < 4; q++) {
    mean[q][0] = (q % 2 ? 0.5 : -0.5) / m->spacing[0];
    mean[q][1] = (q / 2 ? 0.5 : -0.5) / m->spacing[1];
  }
  return m->spacing[0] * m->spacing[1];
}

void element_mean_gradient(const mesh *m, const integration_points *p, int cell,
                           double mean[ELEMENT_MOST_NODES][2]) {
  double area = 0;
  point_shape s;
  memset(mean, 0, ELEMENT_MOST_NODES * sizeof *mean);
  for (int n = p->first[cell]; n < p->first[cell + 1]; n++)
    area += p->area[n];
  for (int n = p->first[cell]; n < p->first[cell + 1]; n++) {
    shape_functions(m, cell, p->at[n], &s);
    for (int q = 0; q < s.count; q++) {
      mean[q][0] += p->area[n] / area * s.nx[q];
      mean[q][1] += p->area[n] / area * s.ny[q];
    }
  }
}

void element_mean_strains(const point_shape *s, const double mean[ELEMENT_MOST_NODES][2],
                          double B[3][2 * ELEMENT_MOST_NODES]) {
  for (int q = 0; q < s->count; q++) {
    const double shift[2] = {0.5 * (mean[q][0] - s->nx[q]), 0.5 * (mean[q][1] - s->ny[q])};
    B[0][2 * q] = s->nx[q] + shift[0];
    B[0][2 * q + 1] = shift[1];
    B[1][2 * q] = shift[0];
    B[1][2 * q + 1] = s->ny[q] + shift[1];
    B[2][2 * q] = s->ny[q];
    B[2][2 * q + 1] = s->nx[q];
  }
}

static bool resists(const mesh *m, int cell) {
  return m->hourglass[cell] > 0 && m->cell[cell] == CELL_ELEMENT && m->element_gauss[cell] == 1 &&
         (!m->lists || m->lists->nodes[cell] == 4);
}

double element_hourglass(const mesh *m, int cell, double gamma[4]) {
  static const double h[4] = {1, -1, -1, 1};
  double at[4][2], mean[4][2], sum = 0, along[2] = {0, 0};
  if (!resists(m, cell)) return 0;
  const double area = middle_gradient(m, cell, mean);
  corners_of(m, cell, at);
  for (int q = 0; q < 4; q++)
    for (int a = 0; a < 2 && (m->mapped || m->lists); a++) /* 0 in a rectangle */
      along[a] += h[q] * (at[q][a] - at[0][a]);
  for (int q = 0; q < 4; q++) {
    gamma[m->lists ? mesh_corner_around(q) : q] =
        0.25 * (h[q] - along[0] * mean[q][0] - along[1] * mean[q][1]);
    sum += mean[q][0] * mean[q][0] + mean[q][1] * mean[q][1];
  }
  return 4 * m->hourglass[cell] * area * sum;
}

double element_strip_stiffness(const double tangent[3][3]) {
  const double across = tangent[0][1] * tangent[1][0];
  const double x = tangent[0][0] - (tangent[1][1] > 0 ? across / tangent[1][1] : 0),
               y = tangent[1][1] - (tangent[0][0] > 0 ? across / tangent[0][0] : 0);
  return pl_max(x, y);
}
