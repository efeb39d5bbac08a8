#include "runtime/mesh/cut_cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/mesh/gauss_rule.h"

static const double NOTHING = 1e-9; /* of a cell's area: as good as none */
static const double SETTLED = 1e-6; /* likewise: an area is known */

/* --- where a cell is divided ------------------------------------------------------------------ */

typedef struct divisions {
  double *at; /* [count] m, ascending once sorted */
  int count, room;
} divisions;

static void divide_at(divisions *d, double at, double lower, double upper) {
  if (!(at >= lower && at <= upper)) return;
  if (d->count == d->room) {
    d->room = d->room ? 2 * d->room : 32;
    d->at = must_realloc(d->at, (size_t)d->room * sizeof *d->at);
  }
  d->at[d->count++] = at;
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* A cell and the holes about it. */
typedef struct cut_cell {
  const mesh *m;
  double lower[2], upper[2];
  mesh_holes near; /* its items are not owned */
} cut_cell;

static cut_cell cell_of(const mesh *m, int cell) {
  const int place[2] = {cell % (m->nodes[0] - 1), cell / (m->nodes[0] - 1)};
  cut_cell c = {.m = m, .near = {.tolerance = m->holes.tolerance}};
  for (int a = 0; a < 2; a++) {
    c.lower[a] = mesh_at(m, a, place[a]);
    c.upper[a] = mesh_at(m, a, place[a] + 1);
  }
  for (int n = 0; n < m->holes.count; n++) {
    const mesh_holes one = {.items = &m->holes.items[n], .count = 1};
    if (holes_meet_box(&one, c.lower, c.upper)) holes_add(&c.near, &one.items->shape);
  }
  return c;
}

/* Where the outlines begin and end, have corners, and cross the two sides along the axis. */
static void divide_by_outlines(const cut_cell *c, int axis, divisions *d) {
  enum { MOST_LEVELS = 256 };
  double level[MOST_LEVELS];
  for (int n = 0; n < c->near.count; n++) {
    const int count = shape_levels(&c->near.items[n].shape, axis, level, MOST_LEVELS);
    for (int k = 0; k < count && k < MOST_LEVELS; k++)
      divide_at(d, level[k], c->lower[axis], c->upper[axis]);
  }
  for (int side = 0; side < 2; side++) {
    double from[2] = {c->lower[0], c->lower[1]}, to[2] = {c->upper[0], c->upper[1]}, *u;
    from[1 - axis] = to[1 - axis] = side ? c->upper[1 - axis] : c->lower[1 - axis];
    const int count = holes_cuts(&c->near, from, to, &u);
    for (int k = 0; k < count; k++)
      divide_at(d, from[axis] + u[k] * (to[axis] - from[axis]), c->lower[axis], c->upper[axis]);
    free(u);
  }
}

static divisions divide(const cut_cell *c, int axis) {
  divisions d = {.count = 0};
  const int parts = c->m->gauss_parts;
  const double size = c->upper[axis] - c->lower[axis];
  for (int k = 0; k <= parts; k++)
    divide_at(&d, k == parts ? c->upper[axis] : c->lower[axis] + size * k / parts, c->lower[axis],
              c->upper[axis]);
  divide_by_outlines(c, axis, &d);
  qsort(d.at, (size_t)d.count, sizeof *d.at, ascending);
  return d;
}

/* --- points ----------------------------------------------------------------------------------- */

static void add(cut_points *p, const double at[2], double area) {
  if (p->count == p->room) {
    p->room = p->room ? 2 * p->room : 256;
    p->at = must_realloc(p->at, (size_t)p->room * sizeof *p->at);
    p->area = must_realloc(p->area, (size_t)p->room * sizeof *p->area);
  }
  memcpy(p->at[p->count], at, sizeof p->at[0]);
  p->area[p->count++] = area;
}

typedef struct rule {
  int order;
  double place[MESH_MOST_GAUSS], weight[MESH_MOST_GAUSS];
} rule;

/* Of the line across the cell at `level` along the axis; it stands for `width` of it. Returns its
   area outside; to: NULL for that alone. */
static double add_line(const cut_cell *c, int axis, const rule *g, double level, double width,
                       cut_points *to) {
  double a[2], b[2], *u, outside = 0;
  a[axis] = b[axis] = level;
  a[1 - axis] = c->lower[1 - axis];
  b[1 - axis] = c->upper[1 - axis];
  const double size = b[1 - axis] - a[1 - axis];
  const int count = holes_cuts(&c->near, a, b, &u), parts = c->m->gauss_parts;
  for (int k = 0; k + 1 < count; k++) {
    double at[2] = {level, level};
    at[1 - axis] = a[1 - axis] + 0.5 * (u[k] + u[k + 1]) * size;
    if (u[k + 1] - u[k] <= 0 || holes_near(&c->near, at, 0)) continue;
    outside += (u[k + 1] - u[k]) * size * width;
    const double part = (u[k + 1] - u[k]) * size / parts;
    for (int n = 0; n < parts && to; n++)
      for (int q = 0; q < g->order; q++) {
        at[1 - axis] = a[1 - axis] + u[k] * size + part * (n + 0.5 * (1 + g->place[q]));
        add(to, at, 0.5 * g->weight[q] * part * width);
      }
  }
  free(u);
  return outside;
}

/* Divided along the axis, each division into so many parts. Returns the area outside. */
static double add_lines(const cut_cell *c, int axis, int parts, cut_points *to) {
  divisions d = divide(c, axis);
  rule g = {.order = c->m->gauss};
  double outside = 0;
  gauss_rule(g.order, g.place, g.weight);
  for (int k = 0; k + 1 < d.count; k++) {
    const double size = (d.at[k + 1] - d.at[k]) / parts;
    if (size <= 1e-12 * (c->upper[axis] - c->lower[axis])) continue;
    for (int n = 0; n < parts * g.order; n++)
      outside +=
          add_line(c, axis, &g, d.at[k] + size * (n / g.order + 0.5 * (1 + g.place[n % g.order])),
                   0.5 * g.weight[n % g.order] * size, to);
  }
  free(d.at);
  return outside;
}

/* Where a round outline is upright along an axis, and where outlines cross, Gauss's places do
   badly: the other axis or more parts, until twice as many change nothing. */
void cut_cell_points(const mesh *m, int cell, cut_points *to) {
  enum { MOST_PARTS = 16 };
  cut_cell c = cell_of(m, cell);
  const double whole = m->spacing[0] * m->spacing[1];
  int axis = 0, parts = 1;
  while (parts < MOST_PARTS && fabs(add_lines(&c, axis, 2 * parts, NULL) -
                                    add_lines(&c, axis, parts, NULL)) > SETTLED * whole) {
    parts *= axis == 1 ? 2 : 1;
    axis = 1 - axis;
  }
  add_lines(&c, axis, parts, to);
  holes_close(&c.near);
}

void cut_points_free(cut_points *p) {
  free(p->at);
  free(p->area);
  *p = (cut_points){.count = 0};
}

/* --- nodes and cells -------------------------------------------------------------------------- */

static void set_cut(mesh *m, int cell) {
  int corner[4];
  m->cut[cell] = 1;
  mesh_corners(m, cell, corner);
  for (int k = 0; k < 4; k++)
    m->element_free[corner[k]] = 1;
}

static void cut_cell_of(mesh *m, int cell, cut_points *scratch) {
  const double whole = m->spacing[0] * m->spacing[1];
  double area = 0;
  scratch->count = 0;
  cut_cell_points(m, cell, scratch);
  for (int n = 0; n < scratch->count; n++)
    area += scratch->area[n];
  if (area >= (1 - NOTHING) * whole) return;
  if (area <= NOTHING * whole) {
    m->cell[cell] = CELL_ABSENT;
    return;
  }
  set_cut(m, cell);
}

/* Of a whole cell the points see all corners. */
static bool is_seen_from(const mesh *m, int cell, const double node[2], cut_points *scratch) {
  if (!m->cut[cell]) return true;
  scratch->count = 0;
  cut_cell_points(m, cell, scratch);
  for (int n = 0; n < scratch->count; n++)
    if (!holes_hide(&m->holes, scratch->at[n], node)) return true;
  return false;
}

static bool is_seen(const mesh *m, int node, cut_points *scratch) {
  int around[ELEMENT_MOST_AROUND];
  double at[2];
  const int count = mesh_cells_around(m, node, around);
  mesh_place(m, node, at);
  for (int k = 0; k < count; k++)
    if (is_seen_from(m, around[k], at, scratch)) return true;
  return false;
}

/* Cells that meet the box of a hole; those outside are whole. */
static bool meets_holes(const mesh *m, int cell) {
  const int i = cell % (m->nodes[0] - 1), j = cell / (m->nodes[0] - 1);
  const double lower[2] = {mesh_at(m, 0, i), mesh_at(m, 1, j)},
               upper[2] = {mesh_at(m, 0, i + 1), mesh_at(m, 1, j + 1)};
  return holes_meet_box(&m->holes, lower, upper);
}

/* A hole may take a node and of a cell only a corner that is as good as nothing. */
static void set_cut_around(mesh *m, int gone) {
  int around[ELEMENT_MOST_AROUND];
  const int count = mesh_cells_around(m, gone, around);
  for (int k = 0; k < count; k++)
    set_cut(m, around[k]);
}

int mesh_cut(mesh *m) {
  cut_points scratch = {.count = 0};
  double at[2];
  int left = 0;
  m->holes.tolerance = 1e-6 * pl_min(m->spacing[0], m->spacing[1]);
  for (int c = 0; c < mesh_cell_count(m) && m->holes.count > 0; c++)
    if (meets_holes(m, c)) cut_cell_of(m, c, &scratch);
  for (int n = 0; n < mesh_node_count(m); n++) {
    mesh_place(m, n, at);
    m->gone[n] = holes_near(&m->holes, at, m->holes.tolerance) &&
                 (holes_hold(&m->holes, at) || !is_seen(m, n, &scratch));
    left += !m->gone[n];
  }
  for (int n = 0; n < mesh_node_count(m); n++)
    if (m->gone[n]) set_cut_around(m, n);
  cut_points_free(&scratch);
  return left;
}
