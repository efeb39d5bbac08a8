#include "runtime/continuum/line_load.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/mesh/integration_points.h"
#include "runtime/mesh/shape_functions.h"

enum { POINTS = 4 };

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Parameters of the line, 0 .. 1, at which it leaves a cell or meets a hole; with its ends. To be
   freed. */
static int cut_line(const mesh *m, const double from[2], const double to[2], double **cuts) {
  double *cut;
  int count = holes_cuts(&m->holes, from, to, &cut);
  cut = must_realloc(cut, ((size_t)(count + m->nodes[0]) + (size_t)m->nodes[1]) * sizeof *cut);
  for (int a = 0; a < 2; a++)
    for (int k = 0; k < m->nodes[a]; k++) {
      const double u = (mesh_at(m, a, k) - from[a]) / (to[a] - from[a]);
      if (u > 0 && u < 1) cut[count++] = u;
    }
  qsort(cut, (size_t)count, sizeof *cut, ascending);
  *cuts = cut;
  return count;
}

/* A point a little to either side of a line along cells' borders is in the cell that is there. */
static int cell_beside(const mesh *m, const double at[2]) {
  const int cell = mesh_cell_of(m, at);
  if (cell < 0 || m->cell[cell] != CELL_ABSENT) return cell;
  for (int k = 0; k < 4; k++) {
    const double there[2] = {at[0] + (k % 2 ? 1e-6 : -1e-6) * m->spacing[0],
                             at[1] + (k / 2 ? 1e-6 : -1e-6) * m->spacing[1]};
    const int other = mesh_cell_of(m, there);
    if (other >= 0 && m->cell[other] != CELL_ABSENT) return other;
  }
  return -1;
}

double line_load(const mesh *m, const double from[2], const double to[2], line_traction traction,
                 void *context, double *const force[2]) {
  const double length = pl_hypot(to[0] - from[0], to[1] - from[1]);
  double place[MESH_MOST_GAUSS], weight[MESH_MOST_GAUSS], loaded = 0;
  double *cut;
  const int count = cut_line(m, from, to, &cut);
  point_shape s;
  gauss_rule(POINTS, place, weight);
  for (int k = 0; k + 1 < count; k++)
    for (int q = 0; q < POINTS && cut[k + 1] > cut[k]; q++) {
      const double u = cut[k] + 0.5 * (cut[k + 1] - cut[k]) * (1 + place[q]);
      const double at[2] = {from[0] + u * (to[0] - from[0]), from[1] + u * (to[1] - from[1])};
      const double part = 0.5 * weight[q] * (cut[k + 1] - cut[k]) * length;
      const int cell = cell_beside(m, at);
      double t[2];
      if (cell < 0 || holes_hold(&m->holes, at)) continue;
      traction(context, at, t);
      shape_functions(m, cell, at, &s);
      loaded += part;
      for (int n = 0; n < s.count; n++)
        for (int d = 0; d < 2; d++)
          force[d][s.node[n]] += m->thickness * part * s.n[n] * t[d];
    }
  free(cut);
  return loaded;
}
