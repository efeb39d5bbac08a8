#include "runtime/continuum/node_matrix.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/mesh/element_modes.h"
#include "runtime/mesh/shape_functions.h"

/* --- which nodes ------------------------------------------------------------------------------ */

static int by_number(const void *p, const void *q) {
  const int32_t a = *(const int32_t *)p, b = *(const int32_t *)q;
  return (a > b) - (a < b);
}

/* Those that share a cell with a node, ascending; how many. */
static int partners(const mesh *m, int node, int32_t *out) {
  int around[MESH_MOST_AROUND], in[ELEMENT_MOST_NODES], count = 0, kept = 0;
  const int cells = mesh_cells_around(m, node, around);
  for (int c = 0; c < cells; c++) {
    const int nodes = mesh_cell_nodes(m, around[c], in);
    for (int q = 0; q < nodes; q++)
      out[count++] = in[q];
  }
  qsort(out, (size_t)count, sizeof *out, by_number);
  for (int k = 0; k < count; k++)
    if (k == 0 || out[k] != out[k - 1]) out[kept++] = out[k];
  return kept;
}

static void find_partners(node_matrix *k, const mesh *m) {
  int32_t found[MESH_MOST_AROUND * ELEMENT_MOST_NODES];
  k->first = must_calloc((size_t)k->nodes + 1, sizeof *k->first);
  for (int n = 0; n < k->nodes; n++)
    k->first[n + 1] = k->first[n] + partners(m, n, found);
  const size_t blocks = (size_t)k->first[k->nodes] + 1;
  k->other = must_alloc(blocks * sizeof *k->other);
  k->site = must_alloc(blocks * sizeof *k->site);
  k->block = must_calloc(blocks, sizeof *k->block);
  for (int n = 0; n < k->nodes; n++) {
    const int count = partners(m, n, found);
    memcpy(k->other + k->first[n], found, (size_t)count * sizeof *found);
    for (int q = 0; q < count; q++)
      k->site[k->first[n] + q] = (int32_t)node_layout_at(&k->layout, found[q]);
  }
}

/* --- blocks ----------------------------------------------------------------------------------- */

static double *block_of(node_matrix *k, int node, int32_t other) {
  const int32_t *at = bsearch(&other, k->other + k->first[node],
                              (size_t)(k->first[node + 1] - k->first[node]), sizeof *at, by_number);
  return k->block[at - k->other];
}

/* Adds w B_a^T D B_b. */
static void add_pair(double block[4], const double D[3][3], double w, const double a[2],
                     const double b[2]) {
  const double left[2][3] = {{a[0], 0, a[1]}, {0, a[1], a[0]}},
               right[2][3] = {{b[0], 0, b[1]}, {0, b[1], b[0]}};
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      double sum = 0;
      for (int r = 0; r < 3; r++)
        for (int s = 0; s < 3; s++)
          sum += left[i][r] * D[r][s] * right[j][s];
      block[2 * i + j] += w * sum;
    }
}

static void add_plain(node_matrix *k, const plane_stiffness *law, const point_shape *s, double w) {
  for (int a = 0; a < s->count; a++)
    for (int b = 0; b < s->count; b++) {
      const double left[2] = {s->nx[a], s->ny[a]}, right[2] = {s->nx[b], s->ny[b]};
      add_pair(block_of(k, s->node[a], s->node[b]), law->D, w, left, right);
    }
}

/* The same with the mean dilatation of the cell. */
static void add_mean(node_matrix *k, const plane_stiffness *law, const point_shape *s,
                     const double mean[ELEMENT_MOST_NODES][2], double w) {
  double B[3][2 * ELEMENT_MOST_NODES];
  element_mean_strains(s, mean, B);
  for (int i = 0; i < 2 * s->count; i++)
    for (int j = 0; j < 2 * s->count; j++) {
      double sum = 0;
      for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
          sum += B[a][i] * law->D[a][b] * B[b][j];
      block_of(k, s->node[i / 2], s->node[j / 2])[2 * (i % 2) + j % 2] += w * sum;
    }
}

void node_matrix_open(node_matrix *k, const mesh *m, const integration_points *p,
                      const plane_stiffness *laws, const unsigned char *law_of_cell) {
  *k = (node_matrix){.layout = node_layout_of(m->nodes, m->support), .nodes = m->lists->node_count};
  find_partners(k, m);
  for (int n = 0; n < p->count; n++) {
    const int cell = p->cell[n];
    const int number = law_of_cell ? law_of_cell[cell] : 0;
    if (number == NO_LINEAR_LAW) continue;
    const plane_stiffness *law = &laws[number];
    point_shape s;
    shape_functions(m, cell, p->at[n], &s);
    const double w = m->thickness * p->area[n];
    if (!element_takes_mean(m, cell)) {
      add_plain(k, law, &s, w);
      continue;
    }
    double mean[ELEMENT_MOST_NODES][2];
    element_mean_gradient(m, p, cell, mean);
    add_mean(k, law, &s, (const double(*)[2])mean, w);
  }
}

void node_matrix_close(node_matrix *k) {
  free(k->first);
  free(k->other);
  free(k->site);
  free(k->block);
}

void node_matrix_multiply(const node_matrix *k, const double *const u[2], double *const f[2],
                          int from, int to) {
  const node_layout *l = &k->layout;
  for (int row = from; row < to; row++) {
    const long start = l->origin + row * l->stride;
    for (int d = 0; d < 2; d++)
      memset(f[d] + start, 0, (size_t)l->padded * sizeof(double));
    for (int i = 0; i < l->nodes[0]; i++) {
      const int node = row * l->nodes[0] + i;
      double x = 0, y = 0;
      if (node >= k->nodes) break;
      for (int32_t e = k->first[node]; e < k->first[node + 1]; e++) {
        const double *b = k->block[e], ux = u[0][k->site[e]], uy = u[1][k->site[e]];
        x += b[0] * ux + b[1] * uy;
        y += b[2] * ux + b[3] * uy;
      }
      f[0][start + i] = x;
      f[1][start + i] = y;
    }
  }
}

long node_matrix_bytes(const node_matrix *k) {
  const long blocks = k->first[k->nodes];
  return blocks * (long)(sizeof *k->block + sizeof *k->other + sizeof *k->site) +
         k->nodes * (long)sizeof *k->first;
}
