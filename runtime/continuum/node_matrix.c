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
  int around[ELEMENT_MOST_AROUND], in[ELEMENT_MOST_NODES], count = 0, kept = 0;
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
  int32_t found[ELEMENT_MOST_AROUND * ELEMENT_MOST_NODES];
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

enum { MOST_MOTIONS = 2 * ELEMENT_MOST_NODES };

/* Strains xx, yy, xy (of engineers) by the motions of the nodes; `mean`: with that dilatation, or
   NULL. */
static void strains_of(const point_shape *s, double (*mean)[2], double B[3][MOST_MOTIONS]) {
  if (mean) {
    element_mean_strains(s, (const double(*)[2])mean, B);
    return;
  }
  for (int q = 0; q < s->count; q++) {
    B[0][2 * q] = B[2][2 * q + 1] = s->nx[q];
    B[1][2 * q + 1] = B[2][2 * q] = s->ny[q];
    B[0][2 * q + 1] = B[1][2 * q] = 0;
  }
}

/* Of the nodes a and b of a point. */
static void add_pair(double block[4], const double D[3][3], double w,
                     const double B[3][MOST_MOTIONS], int a, int b) {
  for (int p = 0; p < 2; p++)
    for (int q = 0; q < 2; q++) {
      double sum = 0;
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
          sum += B[i][2 * a + p] * D[i][j] * B[j][2 * b + q];
      block[2 * p + q] += w * sum;
    }
}

static void add_cell(node_matrix *k, const mesh *m, const integration_points *p,
                     const plane_stiffness *law, int cell) {
  double mean[ELEMENT_MOST_NODES][2];
  const bool means = element_takes_mean(m, cell);
  if (means) element_mean_gradient(m, p, cell, mean);
  for (int n = p->first[cell]; n < p->first[cell + 1]; n++) {
    point_shape s;
    double B[3][MOST_MOTIONS];
    shape_functions(m, cell, p->at[n], &s);
    strains_of(&s, means ? mean : NULL, B);
    for (int a = 0; a < s.count; a++)
      for (int b = 0; b < s.count; b++)
        add_pair(block_of(k, s.node[a], s.node[b]), law->D, m->thickness * p->area[n],
                 (const double(*)[MOST_MOTIONS])B, a, b);
  }
}

void node_matrix_open(node_matrix *k, const mesh *m, const integration_points *p,
                      const plane_stiffness *laws, const unsigned char *law_of_cell) {
  *k = (node_matrix){.layout = node_layout_of(m->nodes, m->support), .nodes = m->lists->node_count};
  find_partners(k, m);
  for (int cell = 0; cell < mesh_cell_count(m); cell++) {
    const int number = law_of_cell ? law_of_cell[cell] : 0;
    if (number != NO_LINEAR_LAW) add_cell(k, m, p, &laws[number], cell);
  }
}

static void resist_in_cell(node_matrix *k, const mesh *m, const plane_stiffness *law, int cell) {
  double gamma[4];
  const double part = element_hourglass(m, cell, gamma);
  const int32_t *node = m->lists->cell[cell];
  if (!(part > 0)) return;
  const double C = m->thickness * part * element_strip_stiffness(law->D);
  for (int a = 0; a < 4; a++)
    for (int b = 0; b < 4; b++) {
      double *block = block_of(k, node[a], node[b]);
      block[0] += C * gamma[a] * gamma[b];
      block[3] += C * gamma[a] * gamma[b];
    }
}

void node_matrix_resist_hourglass(node_matrix *k, const mesh *m, const plane_stiffness *laws,
                                  const unsigned char *law_of_cell) {
  for (int cell = 0; cell < mesh_cell_count(m); cell++) {
    const int number = law_of_cell ? law_of_cell[cell] : 0;
    if (number != NO_LINEAR_LAW) resist_in_cell(k, m, &laws[number], cell);
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
