#include "runtime/mesh/element_strips.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/base/lane_sum.h"
#include "runtime/mesh/shape_functions.h"

/* --- groups ----------------------------------------------------------------------------------- */

static int points_of(const integration_points *p, int cell) {
  return p->first[cell + 1] - p->first[cell];
}

static int row_of(const mesh *m, int cell) {
  int node[ELEMENT_MOST_NODES];
  const int count = mesh_cell_nodes(m, cell, node);
  int first = node[0];
  for (int q = 1; q < count; q++)
    first = node[q] < first ? node[q] : first;
  return first / m->nodes[0];
}

/* Adds a cell to the last group of the row, or begins one. */
static void add_cell(element_strips *s, const integration_points *p, int row, int cell, int nodes) {
  element_group *g = s->group_count > s->first_group[row] ? &s->groups[s->group_count - 1] : NULL;
  if (!g || g->count == PL_LANES || g->nodes != nodes || g->points != points_of(p, cell)) {
    g = &s->groups[s->group_count++];
    *g = (element_group){
        .nodes = nodes, .points = points_of(p, cell), .slot = s->slots, .slope = s->slopes};
    for (int lane = 0; lane < PL_LANES; lane++)
      g->cell[lane] = cell;
    s->slots += (long)nodes * PL_LANES;
    s->slopes += 2L * g->points * nodes * PL_LANES;
  }
  g->cell[g->count++] = cell;
}

/* Cells row by row, and of a row those of a kind together. */
static void find_groups(element_strips *s, const mesh *m, const integration_points *p,
                        const unsigned char *own) {
  static const int kinds[] = {3, 4, 6};
  const size_t cells = (size_t)mesh_cell_count(m) + 1;
  int *first = must_calloc((size_t)s->rows + 2, sizeof *first),
      *row = must_alloc(cells * sizeof *row), *order = must_alloc(cells * sizeof *order);
  for (int c = 0; c < mesh_cell_count(m); c++) {
    row[c] = row_of(m, c);
    first[row[c] + 2]++;
  }
  for (int r = 0; r < s->rows; r++)
    first[r + 1] += first[r];
  for (int c = 0; c < mesh_cell_count(m); c++)
    order[first[row[c] + 1]++] = c;
  s->groups = must_alloc(cells * sizeof *s->groups);
  for (int r = 0; r < s->rows; r++) {
    s->first_group[r] = s->group_count;
    for (int kind = 0; kind < 3; kind++)
      for (int k = first[r]; k < first[r + 1]; k++) {
        const int c = order[k];
        if (m->lists->nodes[c] == kinds[kind] && (!own || own[c]))
          add_cell(s, p, r, c, kinds[kind]);
      }
  }
  s->first_group[s->rows] = s->group_count;
  s->groups = must_realloc(s->groups, ((size_t)s->group_count + 1) * sizeof *s->groups);
  free(first);
  free(row);
  free(order);
}

/* --- what acts -------------------------------------------------------------------------------- */

static void fill_lane(element_strips *s, const mesh *m, const integration_points *p,
                      const element_group *g, int lane) {
  const int cell = g->cell[lane];
  point_shape shape;
  for (int k = 0; k < g->points; k++) {
    shape_functions(m, cell, p->at[p->first[cell] + k], &shape);
    double *slope = s->slope + g->slope + 2L * k * g->nodes * PL_LANES + lane;
    for (int q = 0; q < g->nodes; q++) {
      slope[2 * q * PL_LANES] = shape.nx[q];
      slope[(2 * q + 1) * PL_LANES] = shape.ny[q];
    }
  }
  for (int q = 0; q < g->nodes; q++)
    s->site[g->slot + q * PL_LANES + lane] =
        (int32_t)node_layout_at(&s->layout, m->lists->cell[cell][q]);
}

static void count_slots(element_strips *s, const mesh *m, const element_group *g, int32_t *at) {
  for (int lane = 0; lane < g->count; lane++)
    for (int q = 0; q < g->nodes; q++) {
      const int node = m->lists->cell[g->cell[lane]][q];
      if (at)
        s->slot_of[at[node]++] = (int32_t)(g->slot + q * PL_LANES + lane);
      else
        s->first_of[node + 1]++;
    }
}

static void find_slots(element_strips *s, const mesh *m) {
  const size_t nodes = (size_t)s->nodes + 1;
  s->first_of = must_calloc(nodes, sizeof *s->first_of);
  for (int g = 0; g < s->group_count; g++)
    count_slots(s, m, &s->groups[g], NULL);
  for (int n = 0; n < s->nodes; n++)
    s->first_of[n + 1] += s->first_of[n];
  s->slot_of = must_alloc(((size_t)s->first_of[s->nodes] + 1) * sizeof *s->slot_of);
  int32_t *at = must_alloc(nodes * sizeof *at);
  memcpy(at, s->first_of, nodes * sizeof *at);
  for (int g = 0; g < s->group_count; g++)
    count_slots(s, m, &s->groups[g], at);
  free(at);
}

element_strips *element_strips_new(const mesh *m, const integration_points *p,
                                   const unsigned char *own) {
  element_strips *s = must_calloc(1, sizeof *s);
  s->layout = node_layout_of(m->nodes, m->support);
  s->rows = m->nodes[1];
  s->nodes = m->lists->node_count;
  s->first_group = must_calloc((size_t)s->rows + 1, sizeof *s->first_group);
  find_groups(s, m, p, own);
  s->site = must_alloc(((size_t)s->slots + 1) * sizeof *s->site);
  s->slope = must_align(64, ((size_t)s->slopes + 1) * sizeof *s->slope);
  for (int g = 0; g < s->group_count; g++)
    for (int lane = 0; lane < PL_LANES; lane++)
      fill_lane(s, m, p, &s->groups[g], lane);
  find_slots(s, m);
  return s;
}

void element_strips_free(element_strips *s) {
  if (!s) return;
  free(s->first_group);
  free(s->groups);
  free(s->site);
  free(s->slope);
  free(s->first_of);
  free(s->slot_of);
  free(s);
}

long element_strips_bytes(const element_strips *s) {
  return s->slots * (long)sizeof *s->site + s->slopes * (long)sizeof *s->slope +
         s->group_count * (long)sizeof *s->groups +
         (s->first_of[s->nodes] + s->nodes) * (long)sizeof(int32_t);
}

/* --- strains, forces -------------------------------------------------------------------------- */

void element_strips_strain(const element_strips *s, int group, const double *const u[2],
                           double *const strain[3]) {
  const element_group *g = &s->groups[group];
  const double *slope = s->slope + g->slope;
  double ux[ELEMENT_MOST_NODES][PL_LANES], uy[ELEMENT_MOST_NODES][PL_LANES];
  for (int q = 0; q < g->nodes; q++)
    for (int lane = 0; lane < PL_LANES; lane++) {
      const int32_t site = s->site[g->slot + q * PL_LANES + lane];
      ux[q][lane] = u[0][site];
      uy[q][lane] = u[1][site];
    }
  for (int k = 0; k < g->points; k++) {
    double xx[PL_LANES] = {0}, yy[PL_LANES] = {0}, xy[PL_LANES] = {0};
    for (int q = 0; q < g->nodes; q++, slope += 2 * PL_LANES)
      for (int lane = 0; lane < PL_LANES; lane++) {
        const double nx = slope[lane], ny = slope[PL_LANES + lane];
        xx[lane] += nx * ux[q][lane];
        yy[lane] += ny * uy[q][lane];
        xy[lane] += ny * ux[q][lane] + nx * uy[q][lane];
      }
    for (int lane = 0; lane < PL_LANES; lane++) {
      const bool there = lane < g->count;
      strain[0][k * PL_LANES + lane] = there ? xx[lane] : 0;
      strain[1][k * PL_LANES + lane] = there ? yy[lane] : 0;
      strain[2][k * PL_LANES + lane] = there ? 0.5 * xy[lane] : 0;
    }
  }
}

void element_strips_push(const element_strips *s, int group, const double *const traction[3],
                         double *const pushed[2]) {
  const element_group *g = &s->groups[group];
  double fx[ELEMENT_MOST_NODES][PL_LANES] = {{0}}, fy[ELEMENT_MOST_NODES][PL_LANES] = {{0}};
  const double *slope = s->slope + g->slope;
  for (int k = 0; k < g->points; k++) {
    const double *xx = traction[0] + k * PL_LANES, *yy = traction[1] + k * PL_LANES,
                 *xy = traction[2] + k * PL_LANES;
    for (int q = 0; q < g->nodes; q++, slope += 2 * PL_LANES)
      for (int lane = 0; lane < PL_LANES; lane++) {
        const double nx = slope[lane], ny = slope[PL_LANES + lane];
        fx[q][lane] += nx * xx[lane] + ny * xy[lane];
        fy[q][lane] += ny * yy[lane] + nx * xy[lane];
      }
  }
  const size_t size = (size_t)g->nodes * PL_LANES * sizeof(double);
  memcpy(pushed[0] + g->slot, fx, size);
  memcpy(pushed[1] + g->slot, fy, size);
}

void element_strips_mode(const element_strips *s, int group, const double *gamma, const double *u,
                         double mode[PL_LANES]) {
  const int32_t *site = s->site + s->groups[group].slot;
  for (int lane = 0; lane < PL_LANES; lane++)
    mode[lane] = gamma[lane] * u[site[lane]] + gamma[PL_LANES + lane] * u[site[PL_LANES + lane]] +
                 gamma[2 * PL_LANES + lane] * u[site[2 * PL_LANES + lane]] +
                 gamma[3 * PL_LANES + lane] * u[site[3 * PL_LANES + lane]];
}

void element_strips_push_mode(const element_strips *s, int group, const double *gamma,
                              const double by[PL_LANES], double *pushed) {
  double *to = pushed + s->groups[group].slot;
  for (int k = 0; k < 4 * PL_LANES; k++)
    to[k] += gamma[k] * by[k % PL_LANES];
}

void element_strips_take(const element_strips *s, int row, double *const pushed[2], bool more,
                         double *const force[2]) {
  const node_layout *l = &s->layout;
  const int first = row * l->nodes[0];
  for (int d = 0; d < 2; d++) {
    double *out = force[d] + l->origin + row * l->stride;
    if (!more) memset(out, 0, (size_t)l->padded * sizeof *out);
    for (int i = 0; i < l->nodes[0] && first + i < s->nodes; i++)
      for (int32_t k = s->first_of[first + i]; k < s->first_of[first + i + 1]; k++)
        out[i] += pushed[d][s->slot_of[k]];
  }
}
