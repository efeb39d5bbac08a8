#include "runtime/continuum/node_stencil.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/mesh/element_modes.h"
#include "runtime/mesh/shape_functions.h"

/* --- layout ----------------------------------------------------------------------------------- */

static bool all_elements(const mesh *m) {
  for (int c = 0; c < mesh_cell_count(m); c++)
    if (m->cell[c] != CELL_ELEMENT && m->cell[c] != CELL_ABSENT) return false;
  return true;
}

/* --- blocks ----------------------------------------------------------------------------------- */

static int width(const node_stencil *k) {
  return 2 * k->reach + 1;
}

/* Of the first lane of `node`'s block toward (di, dj), entry 0. */
static double *block_of(const node_stencil *k, int node, int di, int dj) {
  const long i = node % k->layout.nodes[0], j = node / k->layout.nodes[0], w = width(k),
             group = j * (k->layout.padded / PL_LANES) + i / PL_LANES;
  const long at = (group * w + dj + k->reach) * w + di + k->reach;
  return k->blocks + at * 4 * PL_LANES + i % PL_LANES;
}

double node_stencil_entry(const node_stencil *k, int node, int other, int a, int b) {
  const int nx = k->layout.nodes[0], di = other % nx - node % nx, dj = other / nx - node / nx;
  if (abs(di) > k->reach || abs(dj) > k->reach) return 0;
  return block_of(k, node, di, dj)[(2 * a + b) * PL_LANES];
}

/* --- assembly --------------------------------------------------------------------------------- */

const plane_stiffness *node_stencil_law(const node_stencil *k, int cell) {
  const int law = k->law_of_cell ? k->law_of_cell[cell] : 0;
  return law == NO_LINEAR_LAW ? NULL : &k->laws[law];
}

/* Places of the point's nodes in blocks: of node p toward node q at from[p] + to[q]. */
static void find_places(const node_stencil *k, const point_shape *s, long *from, long *to) {
  const int nx = k->layout.nodes[0], w = width(k);
  for (int p = 0; p < s->count; p++) {
    const long i = s->node[p] % nx, j = s->node[p] / nx;
    to[p] = (j * w + i) * 4 * PL_LANES;
    from[p] = block_of(k, s->node[p], 0, 0) - k->blocks - to[p];
  }
}

/* t area sign B_I^T D B_J for all pairs of the point's nodes. */
static void add_point(node_stencil *k, int point, const point_shape *s, double sign) {
  const plane_stiffness *law = node_stencil_law(k, k->points->cell[point]);
  if (!law) return;
  const double factor = sign * k->of->thickness * k->points->area[point];
  long from[SHAPE_MOST_NODES], to[SHAPE_MOST_NODES];
  find_places(k, s, from, to);
  for (int p = 0; p < s->count; p++) {
    double left[2][3]; /* B_I^T D, scaled */
    for (int c = 0; c < 3; c++) {
      left[0][c] = factor * (s->nx[p] * law->D[0][c] + s->ny[p] * law->D[2][c]);
      left[1][c] = factor * (s->ny[p] * law->D[1][c] + s->nx[p] * law->D[2][c]);
    }
    for (int q = 0; q < s->count; q++) {
      double *block = k->blocks + (from[p] + to[q]);
      for (int a = 0; a < 2; a++) {
        block[2 * a * PL_LANES] += left[a][0] * s->nx[q] + left[a][2] * s->ny[q];
        block[(2 * a + 1) * PL_LANES] += left[a][1] * s->ny[q] + left[a][2] * s->nx[q];
      }
    }
  }
}

/* The same as add_point, with the mean dilatation of the cell. */
static void add_mean_point(node_stencil *k, int point, const point_shape *s) {
  const int cell = k->points->cell[point];
  const plane_stiffness *law = node_stencil_law(k, cell);
  const double factor = k->of->thickness * k->points->area[point];
  long from[SHAPE_MOST_NODES], to[SHAPE_MOST_NODES];
  double mean[ELEMENT_MOST_NODES][2], B[3][2 * ELEMENT_MOST_NODES];
  if (!law) return;
  find_places(k, s, from, to);
  element_mean_gradient(k->of, k->points, cell, mean);
  element_mean_strains(s, (const double(*)[2])mean, B);
  for (int p = 0; p < 2 * s->count; p++) {
    double left[3] = {0, 0, 0};
    for (int a = 0; a < 3; a++)
      for (int c = 0; c < 3; c++)
        left[c] += factor * B[a][p] * law->D[a][c];
    for (int q = 0; q < 2 * s->count; q++)
      k->blocks[from[p / 2] + to[q / 2] + (2 * (p % 2) + q % 2) * PL_LANES] +=
          left[0] * B[0][q] + left[1] * B[1][q] + left[2] * B[2][q];
  }
}

static void add_hourglass(node_stencil *k, int cell) {
  const plane_stiffness *law = node_stencil_law(k, cell);
  double gamma[4];
  point_shape s = {.count = 4};
  const double part = law ? element_hourglass(k->of, cell, gamma) : 0;
  long from[SHAPE_MOST_NODES], to[SHAPE_MOST_NODES];
  if (!(part > 0)) return;
  const double C = k->of->thickness * part * element_strip_stiffness(law->D);
  mesh_corners(k->of, cell, s.node);
  find_places(k, &s, from, to);
  for (int p = 0; p < 4; p++)
    for (int q = 0; q < 4; q++)
      for (int a = 0; a < 2; a++)
        k->blocks[from[p] + to[q] + 3 * a * PL_LANES] += C * gamma[p] * gamma[q];
}

void node_stencil_resist_hourglass(node_stencil *k) {
  for (int cell = 0; cell < mesh_cell_count(k->of); cell++)
    add_hourglass(k, cell);
}

void node_stencil_open(node_stencil *k, const mesh *m, const integration_points *p,
                       const plane_stiffness *laws, const unsigned char *law_of_cell) {
  *k = (node_stencil){.layout = node_layout_of(m->nodes, m->support),
                      .reach = all_elements(m) ? 1 : (int)ceil(2 * m->support) - 1,
                      .of = m,
                      .points = p,
                      .laws = laws,
                      .law_of_cell = law_of_cell,
                      .memory = pool_new()};
  k->block_count = k->layout.padded * m->nodes[1] * width(k) * width(k) * 4;
  k->blocks = pool_doubles(k->memory, k->block_count);
  point_shape s;
  for (int n = 0; n < p->count; n++) {
    k->blind += !shape_functions(m, p->cell[n], p->at[n], &s);
    if (element_takes_mean(m, p->cell[n]))
      add_mean_point(k, n, &s);
    else
      add_point(k, n, &s, 1);
  }
}

void node_stencil_close(node_stencil *k) {
  pool_free(k->memory);
}

/* --- product ---------------------------------------------------------------------------------- */

/* Of PL_LANES nodes: blocks and the vectors at the first of them. */
static inline void multiply_group(const node_stencil *k, const double *blocks,
                                  const double *const u[2], double *const f[2], long at) {
  const int reach = k->reach;
  double x[PL_LANES] = {0}, y[PL_LANES] = {0};
  for (int dj = -reach; dj <= reach; dj++) {
    const double *ux = u[0] + at + dj * k->layout.stride, *uy = u[1] + at + dj * k->layout.stride;
    for (int di = -reach; di <= reach; di++, blocks += 4 * PL_LANES)
      for (int lane = 0; lane < PL_LANES; lane++) {
        x[lane] = pl_fma(blocks[lane], ux[di + lane], x[lane]);
        x[lane] = pl_fma(blocks[PL_LANES + lane], uy[di + lane], x[lane]);
        y[lane] = pl_fma(blocks[2 * PL_LANES + lane], ux[di + lane], y[lane]);
        y[lane] = pl_fma(blocks[3 * PL_LANES + lane], uy[di + lane], y[lane]);
      }
  }
  for (int lane = 0; lane < PL_LANES; lane++) {
    f[0][at + lane] = x[lane];
    f[1][at + lane] = y[lane];
  }
}

void node_stencil_multiply(const node_stencil *k, const double *const u[2], double *const f[2],
                           int from, int to) {
  const node_layout *l = &k->layout;
  const long groups = l->padded / PL_LANES, group_size = (long)width(k) * width(k) * 4 * PL_LANES;
  for (long j = from; j < to; j++)
    for (long g = 0; g < groups; g++)
      multiply_group(k, k->blocks + (j * groups + g) * group_size, u, f,
                     l->origin + j * l->stride + g * PL_LANES);
}

/* --- growth ----------------------------------------------------------------------------------- */

static bool is_hidden_by(const mesh *m, const crack_piece *piece, const double at[2],
                         const point_shape *s) {
  double place[2];
  for (int q = 0; q < s->count; q++) {
    mesh_place(m, s->node[q], place);
    if (m->moving[s->node[q]] && crack_piece_hides(piece, at, place)) return true;
  }
  return false;
}

static bool is_within(const double at[2], const double *tip, double radius) {
  return tip && pl_hypot(at[0] - tip[0], at[1] - tip[1]) < radius;
}

/* Points that the piece may concern: of cells within a support of it, or of the enriched radius. */
static void cells_near(const mesh *m, const crack_piece *piece, const double *old_tip, int lower[2],
                       int upper[2]) {
  for (int a = 0; a < 2; a++) {
    const double reach = pl_max(m->support * m->spacing[a], m->enriched);
    double low = pl_min(piece->a[a], piece->b[a]), high = pl_max(piece->a[a], piece->b[a]);
    if (old_tip) {
      low = pl_min(low, old_tip[a]);
      high = pl_max(high, old_tip[a]);
    }
    lower[a] = (int)floor((low - reach - m->corner[a]) / m->spacing[a]) - 1;
    upper[a] = (int)ceil((high + reach - m->corner[a]) / m->spacing[a]) + 1;
    if (lower[a] < 0) lower[a] = 0;
    if (upper[a] > m->nodes[a] - 1) upper[a] = m->nodes[a] - 1;
  }
}

typedef struct changed_points {
  int *point, count, room;
} changed_points;

static void note(changed_points *c, int point) {
  if (c->count == c->room) {
    c->room = c->room ? 2 * c->room : 256;
    c->point = must_realloc(c->point, (size_t)c->room * sizeof *c->point);
  }
  c->point[c->count++] = point;
}

/* Takes the parts of the points away that the piece will change. */
static void subtract_cell(node_stencil *k, int cell, const crack_piece *piece,
                          const double *old_tip, changed_points *changed) {
  const mesh *m = k->of;
  point_shape s;
  if (m->cell[cell] != CELL_INTERFACE && m->cell[cell] != CELL_ELEMENT_FREE) return;
  for (int n = k->points->first[cell]; n < k->points->first[cell + 1]; n++) {
    const double *at = k->points->at[n];
    const bool sees = shape_functions(m, cell, at, &s);
    const bool near_tip = m->enriched > 0 && (is_within(at, old_tip, m->enriched) ||
                                              is_within(at, piece->b, m->enriched));
    if (!near_tip && !is_hidden_by(m, piece, at, &s)) continue;
    k->blind -= !sees;
    add_point(k, n, &s, -1);
    note(changed, n);
  }
}

int node_stencil_grow(node_stencil *k, mesh *m, const double a[2], const double b[2], int tip) {
  const crack_piece piece = {{a[0], a[1]}, {b[0], b[1]}};
  const double *old_tip = tip >= 0 && m->enriched > 0 ? m->cracks.tips[tip] : NULL;
  changed_points changed = {.count = 0};
  int lower[2], upper[2];
  point_shape s;
  cells_near(m, &piece, old_tip, lower, upper);
  for (int j = lower[1]; j < upper[1]; j++)
    for (int i = lower[0]; i < upper[0]; i++)
      subtract_cell(k, mesh_cell_at(m, i, j), &piece, old_tip, &changed);
  crack_lines_add(&m->cracks, a, b);
  if (tip >= 0) memcpy(m->cracks.tips[tip], b, sizeof m->cracks.tips[tip]);
  for (int n = 0; n < changed.count; n++) {
    const int point = changed.point[n];
    k->blind += !shape_functions(m, k->points->cell[point], k->points->at[point], &s);
    add_point(k, point, &s, 1);
  }
  free(changed.point);
  return changed.count;
}
