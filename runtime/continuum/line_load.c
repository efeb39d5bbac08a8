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

/* Where the line meets the straight one through a row (axis 1) or column of nodes of a mapped mesh;
   no number where they are parallel. */
static double cut_by_row(const mesh *m, int axis, int k, const double from[2], const double to[2]) {
  double a[2], b[2];
  const int last = m->nodes[1 - axis] - 1;
  mesh_place(m, axis ? mesh_node(m, 0, k) : mesh_node(m, k, 0), a);
  mesh_place(m, axis ? mesh_node(m, last, k) : mesh_node(m, k, last), b);
  const double row[2] = {b[0] - a[0], b[1] - a[1]}, way[2] = {to[0] - from[0], to[1] - from[1]};
  return ((a[0] - from[0]) * row[1] - (a[1] - from[1]) * row[0]) /
         (way[0] * row[1] - way[1] * row[0]);
}

/* Parameters of the line, 0 .. 1, at which it leaves a cell; with its ends. */
static int cut_line(const mesh *m, const double from[2], const double to[2], double *cut) {
  int count = 0;
  cut[count++] = 0;
  for (int a = 0; a < 2; a++)
    for (int k = 0; k < m->nodes[a]; k++) {
      const double u = m->mapped ? cut_by_row(m, a, k, from, to)
                                 : (mesh_at(m, a, k) - from[a]) / (to[a] - from[a]);
      if (u > 0 && u < 1) cut[count++] = u;
    }
  cut[count++] = 1;
  qsort(cut, (size_t)count, sizeof *cut, ascending);
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

double line_visit(const mesh *m, const double from[2], const double to[2], line_visitor *visit,
                  void *context) {
  const double length = pl_hypot(to[0] - from[0], to[1] - from[1]);
  double place[MESH_MOST_GAUSS], weight[MESH_MOST_GAUSS], loaded = 0;
  double *cut = must_alloc(((size_t)m->nodes[0] + (size_t)m->nodes[1] + 2) * sizeof *cut);
  const int count = cut_line(m, from, to, cut);
  point_shape s;
  gauss_rule(POINTS, place, weight);
  for (int k = 0; k + 1 < count; k++)
    for (int q = 0; q < POINTS && cut[k + 1] > cut[k]; q++) {
      const double u = cut[k] + 0.5 * (cut[k + 1] - cut[k]) * (1 + place[q]);
      const double at[2] = {from[0] + u * (to[0] - from[0]), from[1] + u * (to[1] - from[1])};
      const double part = 0.5 * weight[q] * (cut[k + 1] - cut[k]) * length;
      const int cell = cell_beside(m, at);
      if (cell < 0) continue;
      shape_functions(m, cell, at, &s);
      visit(context, at, m->thickness * part, &s);
      loaded += part;
    }
  free(cut);
  return loaded;
}

typedef struct loading {
  line_traction traction;
  void *context;
  double *const *force;
} loading;

static void load_nodes(void *context, const double at[2], double area, const point_shape *s) {
  const loading *l = context;
  double t[2];
  l->traction(l->context, at, t);
  for (int n = 0; n < s->count; n++)
    for (int d = 0; d < 2; d++)
      l->force[d][s->node[n]] += area * s->n[n] * t[d];
}

double line_load(const mesh *m, const double from[2], const double to[2], line_traction traction,
                 void *context, double *const force[2]) {
  loading l = {traction, context, force};
  return line_visit(m, from, to, load_nodes, &l);
}
