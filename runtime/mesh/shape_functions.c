#include "runtime/mesh/shape_functions.h"

/* Of an element in lists; the place that a point has in it is sought. */
static bool of_lists(const mesh *m, int cell, const double at[2], point_shape *out) {
  const int count = mesh_cell_nodes(m, cell, out->node);
  double corner[ELEMENT_MOST_NODES][2], u[2], gradient[ELEMENT_MOST_NODES][2];
  cell_lists_places(m->lists, cell, corner);
  const bool found = element_unmap(count, (const double(*)[2])corner, at, u);
  element_gradients(count, (const double(*)[2])corner, u, out->n, gradient);
  out->count = count;
  for (int k = 0; k < count; k++) {
    out->nx[k] = gradient[k][0];
    out->ny[k] = gradient[k][1];
  }
  return found;
}

/* The same where the mesh is mapped, whose map is the cell's own. */
static void isoparametric(const mesh *m, int cell, const double at[2], point_shape *out) {
  const int place[2] = {cell % (m->nodes[0] - 1), cell / (m->nodes[0] - 1)};
  double unit[2], here[2], slope[2][2], along[2][2];
  quadrilateral_unmap(m->corners, at, unit);
  quadrilateral_map(m->corners, unit, here, slope);
  const double turn = quadrilateral_jacobian(slope);
  for (int a = 0; a < 2; a++) {
    along[a][1] = unit[a] * (m->nodes[a] - 1) - place[a];
    along[a][0] = 1 - along[a][1];
  }
  mesh_corners(m, cell, out->node);
  out->count = 4;
  for (int k = 0; k < 4; k++) {
    const double nu = (k % 2 ? 1 : -1) * (m->nodes[0] - 1) * along[1][k / 2],
                 nv = (k / 2 ? 1 : -1) * (m->nodes[1] - 1) * along[0][k % 2];
    out->n[k] = along[0][k % 2] * along[1][k / 2];
    out->nx[k] = (nu * slope[1][1] - nv * slope[1][0]) / turn;
    out->ny[k] = (nv * slope[0][0] - nu * slope[0][1]) / turn;
  }
}

/* The four of the cell's corners. */
static void bilinear(const mesh *m, int cell, const double at[2], point_shape *out) {
  const int i = cell % (m->nodes[0] - 1), j = cell / (m->nodes[0] - 1);
  const double dx = m->spacing[0], dy = m->spacing[1], u = (at[0] - mesh_at(m, 0, i)) / dx,
               v = (at[1] - mesh_at(m, 1, j)) / dy;
  const double along[2] = {1 - u, u}, up[2] = {1 - v, v};
  mesh_corners(m, cell, out->node);
  out->count = 4;
  for (int k = 0; k < 4; k++) {
    out->n[k] = along[k % 2] * up[k / 2];
    out->nx[k] = (k % 2 ? 1 : -1) / dx * up[k / 2];
    out->ny[k] = (k / 2 ? 1 : -1) / dy * along[k % 2];
  }
}

/* R and its gradient. */
static double ramp(const mesh *m, const point_shape *corners, double slope[2]) {
  double R = 0;
  slope[0] = slope[1] = 0;
  for (int k = 0; k < 4; k++) {
    if (!m->element_free[corners->node[k]]) continue;
    R += corners->n[k];
    slope[0] += corners->nx[k];
    slope[1] += corners->ny[k];
  }
  if (!m->smooth_ramp) return R;
  slope[0] *= 6 * (R - R * R);
  slope[1] *= 6 * (R - R * R);
  return 3 * R * R - 2 * R * R * R;
}

static int place_of(point_shape *s, int node) {
  int k = 0;
  while (k < s->count && s->node[k] != node)
    k++;
  if (k < s->count) return k;
  s->node[k] = node;
  s->n[k] = s->nx[k] = s->ny[k] = 0;
  s->count++;
  return k;
}

static void blend(const mesh *m, const point_shape *corners, point_shape *s) {
  double slope[2];
  const double R = ramp(m, corners, slope);
  for (int k = 0; k < s->count; k++) {
    s->nx[k] = slope[0] * s->n[k] + R * s->nx[k];
    s->ny[k] = slope[1] * s->n[k] + R * s->ny[k];
    s->n[k] *= R;
  }
  for (int k = 0; k < 4; k++) {
    const int at = place_of(s, corners->node[k]);
    s->n[at] += (1 - R) * corners->n[k];
    s->nx[at] += (1 - R) * corners->nx[k] - slope[0] * corners->n[k];
    s->ny[at] += (1 - R) * corners->ny[k] - slope[1] * corners->n[k];
  }
}

bool shape_functions(const mesh *m, int cell, const double at[2], point_shape *out) {
  if (m->lists) return of_lists(m, cell, at, out);
  if (m->cell[cell] == CELL_ELEMENT) {
    if (m->mapped)
      isoparametric(m, cell, at, out);
    else
      bilinear(m, cell, at, out);
    return true;
  }
  const bool sees = moving_least_squares(m, at, out);
  if (m->cell[cell] != CELL_INTERFACE) return sees;
  point_shape corners;
  bilinear(m, cell, at, &corners);
  blend(m, &corners, out);
  return sees;
}
