#include "runtime/mesh/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

static void open_flags(mesh *m) {
  const size_t count = (size_t)mesh_node_count(m), cells = (size_t)mesh_cell_count(m);
  m->element_free = must_alloc(count);
  m->moving = must_calloc(count, 1);
  m->gone = must_calloc(count, 1);
  m->cut = must_calloc(cells, 1);
  m->cell = must_alloc(cells);
  m->element_gauss = must_alloc(cells);
  m->mean_dilatation = must_calloc(cells, 1);
  m->hourglass = must_calloc(cells, sizeof *m->hourglass);
  memset(m->element_free, 1, count);
  memset(m->cell, CELL_ELEMENT_FREE, cells);
  memset(m->element_gauss, 2, cells);
  crack_lines_open(&m->cracks);
  holes_open(&m->holes);
}

void mesh_open(mesh *m, const int nodes[2], const double corner[2], const double size[2],
               double thickness, double support) {
  *m = (mesh){.thickness = thickness, .support = support, .gauss = 4, .gauss_parts = 1};
  for (int a = 0; a < 2; a++) {
    m->nodes[a] = nodes[a];
    m->corner[a] = corner[a];
    m->spacing[a] = size[a] / (nodes[a] - 1);
  }
  open_flags(m);
  mesh_settle(m);
}

void mesh_open_lists(mesh *m, const int nodes[2], cell_lists *l, double least, double thickness,
                     double support) {
  *m = (mesh){.nodes = {nodes[0], nodes[1]},
              .corner = {l->low[0], l->low[1]},
              .spacing = {least, least},
              .thickness = thickness,
              .support = support,
              .gauss = 4,
              .gauss_parts = 1,
              .lists = l};
  open_flags(m);
  memset(m->element_free, 0, (size_t)mesh_node_count(m));
  for (int n = l->node_count; n < mesh_node_count(m); n++)
    m->gone[n] = 1;
  mesh_settle(m);
}

void mesh_close(mesh *m) {
  cell_lists_free(m->lists);
  free(m->element_free);
  free(m->moving);
  free(m->gone);
  free(m->cut);
  free(m->cell);
  free(m->element_gauss);
  free(m->mean_dilatation);
  free(m->hourglass);
  crack_lines_close(&m->cracks);
  holes_close(&m->holes);
}

void mesh_settle(mesh *m) {
  int corner[4];
  memset(m->moving, 0, (size_t)mesh_node_count(m));
  if (m->lists) {
    memset(m->cell, CELL_ELEMENT, (size_t)mesh_cell_count(m));
    return;
  }
  for (int c = 0; c < mesh_cell_count(m); c++) {
    if (m->cell[c] == CELL_ABSENT) continue;
    mesh_corners(m, c, corner);
    int free_corners = 0;
    for (int k = 0; k < 4; k++)
      free_corners += m->element_free[corner[k]];
    m->cell[c] = (unsigned char)(free_corners == 0   ? CELL_ELEMENT
                                 : free_corners == 4 ? CELL_ELEMENT_FREE
                                                     : CELL_INTERFACE);
    for (int k = 0; k < 4 && free_corners > 0; k++)
      m->moving[corner[k]] = !m->gone[corner[k]];
  }
}

void mesh_open_mapped(mesh *m, const int nodes[2], const double corners[4][2], double thickness,
                      double support) {
  double lower[2], upper[2];
  quadrilateral_box(corners, lower, upper);
  const double size[2] = {upper[0] - lower[0], upper[1] - lower[1]};
  mesh_open(m, nodes, lower, size, thickness, support);
  m->mapped = true;
  memcpy(m->corners, corners, sizeof m->corners);
  memset(m->element_free, 0, (size_t)mesh_node_count(m));
  mesh_settle(m);
}

int mesh_cell_nodes(const mesh *m, int cell, int node[ELEMENT_MOST_NODES]) {
  int corner[4];
  if (m->lists) {
    for (int q = 0; q < m->lists->nodes[cell]; q++)
      node[q] = m->lists->cell[cell][q];
    return m->lists->nodes[cell];
  }
  mesh_corners(m, cell, corner);
  for (int k = 0; k < 4; k++)
    node[k] = corner[mesh_corner_around(k)];
  return 4;
}

static int listed_around(const cell_lists *l, int node, int around[ELEMENT_MOST_AROUND]) {
  const int count = node < l->node_count ? l->first[node + 1] - l->first[node] : 0;
  for (int k = 0; k < count; k++)
    around[k] = l->around[l->first[node] + k];
  return count;
}

int mesh_cells_around(const mesh *m, int node, int around[ELEMENT_MOST_AROUND]) {
  if (m->lists) return listed_around(m->lists, node, around);
  const int i = node % m->nodes[0], j = node / m->nodes[0];
  int count = 0;
  for (int k = 0; k < 4; k++) {
    const int a = i - 1 + k % 2, b = j - 1 + k / 2;
    if (a < 0 || b < 0 || a > m->nodes[0] - 2 || b > m->nodes[1] - 2) continue;
    if (m->cell[mesh_cell_at(m, a, b)] != CELL_ABSENT) around[count++] = mesh_cell_at(m, a, b);
  }
  return count;
}

double mesh_cell_size(const mesh *m, int cell) {
  int node[ELEMENT_MOST_NODES];
  double at[ELEMENT_MOST_NODES][2];
  if (!m->mapped && !m->lists) return sqrt(m->spacing[0] * m->spacing[1]);
  const int count = mesh_cell_nodes(m, cell, node);
  for (int k = 0; k < count; k++)
    mesh_place(m, node[k], at[k]);
  /* a row of triangles of 3 nodes is made of halves of cells */
  return sqrt((count == 3 ? 2 : 1) * element_area(count, (const double(*)[2])at));
}

double mesh_cell_slender(const mesh *m, int cell) {
  int node[ELEMENT_MOST_NODES];
  double at[ELEMENT_MOST_NODES][2], across[2] = {0};
  if (mesh_cell_nodes(m, cell, node) != 4) return 1;
  for (int k = 0; k < 4; k++)
    mesh_place(m, node[k], at[k]);
  for (int k = 0; k < 4; k++) {
    const double *to = at[(k + 1) % 4];
    const double x = to[0] - at[k][0], y = to[1] - at[k][1];
    across[k % 2] += sqrt(x * x + y * y);
  }
  return across[0] > across[1] ? across[0] / across[1] : across[1] / across[0];
}

void mesh_strain_place(const mesh *m, int cell, const double place[2], double at[2]) {
  int corner[ELEMENT_MOST_NODES];
  double here[2];
  memcpy(at, place, 2 * sizeof *at);
  if (m->cell[cell] != CELL_ELEMENT || m->element_gauss[cell] > 1) return;
  if (mesh_cell_nodes(m, cell, corner) != 4) return; /* of a triangle: the same, or two */
  at[0] = at[1] = 0;
  for (int k = 0; k < 4; k++) {
    mesh_place(m, corner[k], here);
    for (int a = 0; a < 2; a++)
      at[a] += 0.25 * here[a];
  }
}

/* On a border of the absent cell at `place` another one may hold the point; u: in cells. */
static int cell_across(const mesh *m, const int place[2], const double u[2]) {
  const double near = 1e-6;
  int low[2], high[2];
  for (int a = 0; a < 2; a++) {
    low[a] = u[a] - place[a] < near && place[a] > 0 ? place[a] - 1 : place[a];
    high[a] = place[a] + 1 - u[a] < near && place[a] < m->nodes[a] - 2 ? place[a] + 1 : place[a];
  }
  for (int j = low[1]; j <= high[1]; j++)
    for (int i = low[0]; i <= high[0]; i++)
      if (m->cell[mesh_cell_at(m, i, j)] != CELL_ABSENT) return mesh_cell_at(m, i, j);
  return mesh_cell_at(m, place[0], place[1]);
}

int mesh_cell_of(const mesh *m, const double at[2]) {
  double unit[2], u[2];
  int place[2];
  if (m->lists) return cell_lists_find(m->lists, at, u);
  if (m->mapped) quadrilateral_unmap(m->corners, at, unit);
  for (int a = 0; a < 2; a++) {
    const double cells = m->nodes[a] - 1;
    u[a] = m->mapped ? unit[a] * cells : (at[a] - m->corner[a]) / m->spacing[a];
    if (!(u[a] >= -1e-9 * cells && u[a] <= cells * (1 + 1e-9))) return -1;
    place[a] = (int)floor(u[a]);
    if (place[a] < 0) place[a] = 0;
    if (place[a] > m->nodes[a] - 2) place[a] = m->nodes[a] - 2;
  }
  const int cell = mesh_cell_at(m, place[0], place[1]);
  return m->cell[cell] == CELL_ABSENT ? cell_across(m, place, u) : cell;
}
