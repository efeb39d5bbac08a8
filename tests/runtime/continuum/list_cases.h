/* Meshes of lists for tests: a square of n x n cells whose inner nodes are moved, of triangles of 3
   or 6 nodes or of quadrilaterals. */
#ifndef PERILAT_TESTS_LIST_CASES_H
#define PERILAT_TESTS_LIST_CASES_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/base/random_number.h"
#include "runtime/continuum/node_matrix.h"
#include "runtime/kernel.h"
#include "runtime/mesh/cell_lists.h"

enum { MIXED = 34 }; /* triangles of 3 nodes, and quadrilaterals */

typedef struct list_mesh {
  mesh m;
  integration_points points;
  int n; /* cells along a side */
} list_mesh;

/* Node (i, j) of the finest grid that nodes stand on: every half cell. */
typedef struct list_maker {
  int n, kind, count, cells;
  int *number; /* [(2 n + 1)^2] or -1 */
  double (*at)[2];
  unsigned char *nodes;
  cell_nodes *cell;
} list_maker;

static inline int list_node(list_maker *k, int i, int j) {
  int *number = &k->number[j * (2 * k->n + 1) + i];
  if (*number < 0) {
    *number = k->count;
    k->at[k->count][0] = 0.5 * i / k->n;
    k->at[k->count++][1] = 0.5 * j / k->n;
  }
  return *number;
}

static inline void list_triangle(list_maker *k, const int corner[3][2]) {
  int32_t *to = k->cell[k->cells];
  const int nodes = k->kind == 6 ? 6 : 3;
  for (int q = 0; q < 3; q++)
    to[q] = list_node(k, corner[q][0], corner[q][1]);
  for (int q = 0; q < 3 && nodes == 6; q++)
    to[3 + q] = list_node(k, (corner[q][0] + corner[(q + 1) % 3][0]) / 2,
                          (corner[q][1] + corner[(q + 1) % 3][1]) / 2);
  k->nodes[k->cells++] = (unsigned char)nodes;
}

static inline void list_square(list_maker *k, int i, int j) {
  const int x = 2 * i, y = 2 * j;
  if (k->kind == 4 || (k->kind == MIXED && (i + j) % 3 == 0)) {
    int32_t *to = k->cell[k->cells];
    to[0] = list_node(k, x, y);
    to[1] = list_node(k, x + 2, y);
    to[2] = list_node(k, x + 2, y + 2);
    to[3] = list_node(k, x, y + 2);
    k->nodes[k->cells++] = 4;
    return;
  }
  list_triangle(k, (const int[3][2]){{x, y}, {x + 2, y}, {x + 2, y + 2}});
  list_triangle(k, (const int[3][2]){{x, y}, {x + 2, y + 2}, {x, y + 2}});
}

/* Corners inside are moved by up to a fifth of a cell, nodes of sides stay in their middle. */
static inline void list_distort(list_maker *k, double part) {
  for (int n = 0; n < k->count; n++) {
    const double x = 2 * k->n * k->at[n][0], y = 2 * k->n * k->at[n][1];
    const bool corner = fmod(round(x), 2) == 0 && fmod(round(y), 2) == 0;
    const bool edge = x < 0.5 || y < 0.5 || x > 2 * k->n - 0.5 || y > 2 * k->n - 0.5;
    for (int a = 0; a < 2 && corner && !edge; a++)
      k->at[n][a] += part / k->n * (random_unit(random_mix((uint64_t)(2 * n + a))) - 0.5);
  }
  for (int c = 0; c < k->cells && k->kind == 6; c++)
    for (int q = 0; q < 3; q++)
      for (int a = 0; a < 2; a++)
        k->at[k->cell[c][3 + q]][a] =
            0.5 * (k->at[k->cell[c][q]][a] + k->at[k->cell[c][(q + 1) % 3]][a]);
}

/* kind: 3, 4, 6 or MIXED; `part` of a cell that nodes are moved by. */
static inline void list_open(list_mesh *l, int n, int kind, double part, int gauss) {
  const size_t all = (size_t)((2 * n + 1) * (2 * n + 1)), most = 2 * (size_t)(n * n);
  list_maker k = {.n = n,
                  .kind = kind,
                  .number = must_alloc(all * sizeof(int)),
                  .at = must_calloc(all, 2 * sizeof(double)),
                  .nodes = must_calloc(most, 1),
                  .cell = must_calloc(most, sizeof(cell_nodes))};
  for (size_t q = 0; q < all; q++)
    k.number[q] = -1;
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++)
      list_square(&k, i, j);
  list_distort(&k, part);
  cell_lists *lists = cell_lists_new(k.count, (const double(*)[2])k.at, k.cells, k.nodes,
                                     (const cell_nodes *)k.cell);
  const int wide = (int)(PL_LANES * ceil(sqrt(k.count) / PL_LANES));
  l->n = n;
  mesh_open_lists(&l->m, (int[2]){wide, k.count / wide + 1}, lists, 1.0 / n, 0.5, 1);
  memset(l->m.element_gauss, gauss, (size_t)k.cells);
  integration_points_open(&l->points, &l->m);
  free(k.number);
  free(k.at);
  free(k.nodes);
  free(k.cell);
}

static inline void list_close(list_mesh *l) {
  integration_points_close(&l->points);
  mesh_close(&l->m);
}

static inline bool list_on_edge(const list_mesh *l, int node) {
  double at[2];
  mesh_place(&l->m, node, at);
  return at[0] < 1e-9 || at[1] < 1e-9 || at[0] > 1 - 1e-9 || at[1] > 1 - 1e-9;
}

#endif
