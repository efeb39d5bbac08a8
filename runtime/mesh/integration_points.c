#include "runtime/mesh/integration_points.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/mesh/cut_cells.h"

static void rule_of(const mesh *m, int cell, int *order, int *parts) {
  const bool element = m->cell[cell] == CELL_ELEMENT;
  *order = element ? m->element_gauss[cell] : m->gauss;
  *parts = element ? 1 : m->gauss_parts;
}

static int points_of(const mesh *m, int cell) {
  int order, parts;
  double u[ELEMENT_MOST_POINTS][2], weight[ELEMENT_MOST_POINTS];
  if (m->cell[cell] == CELL_ABSENT) return 0;
  if (m->lists) return element_rule(m->lists->nodes[cell], m->element_gauss[cell], u, weight);
  if (m->cut[cell]) {
    cut_points p = {.count = 0};
    cut_cell_points(m, cell, &p);
    const int count = p.count;
    cut_points_free(&p);
    return count;
  }
  rule_of(m, cell, &order, &parts);
  return order * order * parts * parts;
}

static void place_cut_points(integration_points *p, const mesh *m, int cell, int first) {
  cut_points own = {.count = 0};
  cut_cell_points(m, cell, &own);
  memcpy(p->at + first, own.at, (size_t)own.count * sizeof *p->at);
  memcpy(p->area + first, own.area, (size_t)own.count * sizeof *p->area);
  for (int n = 0; n < own.count; n++)
    p->cell[first + n] = cell;
  cut_points_free(&own);
}

static void place_points(integration_points *p, const mesh *m, int cell, int first) {
  const int i = cell % (m->nodes[0] - 1), j = cell / (m->nodes[0] - 1);
  int order, parts, at = first;
  double place[MESH_MOST_GAUSS], weight[MESH_MOST_GAUSS];
  rule_of(m, cell, &order, &parts);
  gauss_rule(order, place, weight);
  const double size[2] = {m->spacing[0] / parts, m->spacing[1] / parts};
  for (int up = 0; up < parts; up++)
    for (int along = 0; along < parts; along++)
      for (int b = 0; b < order; b++)
        for (int a = 0; a < order; a++, at++) {
          p->at[at][0] = mesh_at(m, 0, i) + size[0] * (along + 0.5 * (1 + place[a]));
          p->at[at][1] = mesh_at(m, 1, j) + size[1] * (up + 0.5 * (1 + place[b]));
          p->area[at] = 0.25 * weight[a] * weight[b] * size[0] * size[1];
          p->cell[at] = cell;
        }
}

/* Of a cell of a mapped mesh, an element. */
static void place_mapped(integration_points *p, const mesh *m, int cell, int first) {
  const int i = cell % (m->nodes[0] - 1), j = cell / (m->nodes[0] - 1);
  const double cells[2] = {m->nodes[0] - 1, m->nodes[1] - 1};
  const int order = m->element_gauss[cell];
  double place[MESH_MOST_GAUSS], weight[MESH_MOST_GAUSS];
  gauss_rule(order, place, weight);
  for (int n = 0; n < order * order; n++) {
    const int a = n % order, b = n / order;
    const double u[2] = {(i + 0.5 * (1 + place[a])) / cells[0],
                         (j + 0.5 * (1 + place[b])) / cells[1]};
    double slope[2][2];
    quadrilateral_map(m->corners, u, p->at[first + n], slope);
    p->area[first + n] =
        0.25 * weight[a] * weight[b] / (cells[0] * cells[1]) * quadrilateral_jacobian(slope);
    p->cell[first + n] = cell;
  }
}

static void place_listed(integration_points *p, const mesh *m, int cell, int first) {
  const int nodes = m->lists->nodes[cell];
  double u[ELEMENT_MOST_POINTS][2], weight[ELEMENT_MOST_POINTS], corner[ELEMENT_MOST_NODES][2];
  cell_lists_places(m->lists, cell, corner);
  const int count = element_rule(nodes, m->element_gauss[cell], u, weight);
  for (int n = 0; n < count; n++) {
    const double turn =
        element_map(nodes, (const double(*)[2])corner, u[n], p->at[first + n], NULL);
    p->area[first + n] = weight[n] * turn;
    p->cell[first + n] = cell;
  }
}

void integration_points_open(integration_points *p, const mesh *m) {
  const int cells = mesh_cell_count(m);
  *p = (integration_points){.first = must_alloc(((size_t)cells + 1) * sizeof *p->first)};
  for (int c = 0; c < cells; c++) {
    p->first[c] = p->count;
    p->count += points_of(m, c);
  }
  p->first[cells] = p->count;
  const size_t count = (size_t)p->count + 1;
  p->at = must_alloc(count * sizeof *p->at);
  p->area = must_alloc(count * sizeof *p->area);
  p->cell = must_alloc(count * sizeof *p->cell);
  for (int c = 0; c < cells; c++)
    if (p->first[c + 1] > p->first[c])
      (m->lists    ? place_listed
       : m->mapped ? place_mapped
       : m->cut[c] ? place_cut_points
                   : place_points)(p, m, c, p->first[c]);
}

void integration_points_close(integration_points *p) {
  free(p->at);
  free(p->area);
  free(p->cell);
  free(p->first);
}
