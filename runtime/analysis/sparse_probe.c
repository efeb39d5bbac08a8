#include "runtime/analysis/sparse_probe.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

/* --- who feels whom --------------------------------------------------------------------------- */

static int ascending(const void *a, const void *b) {
  const int32_t p = *(const int32_t *)a, q = *(const int32_t *)b;
  return (p > q) - (p < q);
}

/* Each node's list in order, and each of it once. */
static void put_in_order(sparse_graph *g) {
  long kept = 0;
  for (long n = 0; n < g->count; n++) {
    const long from = g->begin[n], end = g->begin[n + 1];
    qsort(g->near + from, (size_t)(end - from), sizeof *g->near, ascending);
    g->begin[n] = kept;
    for (long k = from; k < end; k++)
      if (k == from || g->near[k] != g->near[k - 1]) g->near[kept++] = g->near[k];
  }
  g->begin[g->count] = kept;
}

static sparse_graph graph_with(long nodes) {
  return (sparse_graph){.count = nodes, .begin = must_calloc((size_t)nodes + 2, sizeof(long))};
}

sparse_graph sparse_graph_new(long nodes, const int32_t (*pairs)[2], long count) {
  sparse_graph g = graph_with(nodes);
  g.near = must_alloc((size_t)(nodes + 2 * count + 1) * sizeof *g.near);
  for (long k = 0; k < count; k++)
    for (int end = 0; end < 2; end++)
      g.begin[pairs[k][end] + 1]++;
  for (long n = 0; n < nodes; n++)
    g.begin[n + 1] += g.begin[n] + 1;
  long *next = must_alloc(((size_t)nodes + 1) * sizeof *next);
  for (long n = 0; n < nodes; n++) {
    next[n] = g.begin[n];
    g.near[next[n]++] = (int32_t)n;
  }
  for (long k = 0; k < count; k++)
    for (int end = 0; end < 2; end++)
      g.near[next[pairs[k][end]]++] = pairs[k][1 - end];
  free(next);
  put_in_order(&g);
  return g;
}

/* Nodes within a step of those of `from`. `seen` [count] holds marks other than `mark`. */
static long step_from(const sparse_graph *one, const int32_t *from, long count, int32_t *found,
                      long *seen, long mark) {
  long many = 0;
  for (long a = 0; a < count; a++)
    for (long k = one->begin[from[a]]; k < one->begin[from[a] + 1]; k++) {
      const int32_t n = one->near[k];
      if (seen[n] != mark) found[many++] = n;
      seen[n] = mark;
    }
  return many;
}

/* Those within a step of what `of` has. */
static sparse_graph graph_further(const sparse_graph *of, const sparse_graph *one) {
  sparse_graph g = graph_with(of->count);
  const size_t nodes = (size_t)of->count + 1;
  int32_t *found = must_alloc(nodes * sizeof *found);
  long *seen = must_calloc(nodes, sizeof *seen), room = 0;
  for (long n = 0; n < of->count; n++) {
    const long many = step_from(one, of->near + of->begin[n], of->begin[n + 1] - of->begin[n],
                                found, seen, n + 1);
    g.begin[n + 1] = g.begin[n] + many;
    if (g.begin[n + 1] > room) {
      room = 2 * g.begin[n + 1];
      g.near = must_realloc(g.near, (size_t)room * sizeof *g.near);
    }
    memcpy(g.near + g.begin[n], found, (size_t)many * sizeof *found);
  }
  free(found);
  free(seen);
  put_in_order(&g);
  return g;
}

sparse_graph sparse_graph_reach(const sparse_graph *g, int steps) {
  sparse_graph reach = sparse_graph_new(g->count, NULL, 0);
  for (int s = 0; s < steps; s++) {
    sparse_graph further = graph_further(&reach, g);
    sparse_graph_free(&reach);
    reach = further;
  }
  return reach;
}

void sparse_graph_free(sparse_graph *g) {
  free(g->begin);
  free(g->near);
}

/* --- colours ---------------------------------------------------------------------------------- */

/* The first colour that no node has which feels a common one; *colours: how many there are. */
static int32_t *colours_of(const sparse_graph *g, int32_t *colours) {
  int32_t *colour = must_alloc(((size_t)g->count + 1) * sizeof *colour);
  long *taken = must_calloc((size_t)g->count + 1, sizeof *taken);
  *colours = 0;
  for (long n = 0; n < g->count; n++)
    colour[n] = -1;
  for (long n = 0; n < g->count; n++) {
    for (long k = g->begin[n]; k < g->begin[n + 1]; k++)
      for (long m = g->begin[g->near[k]]; m < g->begin[g->near[k] + 1]; m++)
        if (colour[g->near[m]] >= 0) taken[colour[g->near[m]]] = n + 1;
    int32_t c = 0;
    while (taken[c] == n + 1)
      c++;
    colour[n] = c;
    if (c >= *colours) *colours = c + 1;
  }
  free(taken);
  return colour;
}

/* --- the matrix ------------------------------------------------------------------------------- */

typedef struct probe {
  const sparse_graph *g;
  const long *first;
  int64_t *begin, *row; /* of all of the matrix, by columns */
  double *value;
} probe;

static void lay_out(probe *p) {
  const sparse_graph *g = p->g;
  const long order = p->first[g->count];
  p->begin = must_calloc((size_t)order + 1, sizeof *p->begin);
  for (long n = 0; n < g->count; n++) {
    long rows = 0;
    for (long k = g->begin[n]; k < g->begin[n + 1]; k++)
      rows += p->first[g->near[k] + 1] - p->first[g->near[k]];
    for (long c = p->first[n]; c < p->first[n + 1]; c++)
      p->begin[c + 1] = p->begin[c] + rows;
  }
  p->row = must_alloc((size_t)(p->begin[order] + 1) * sizeof *p->row);
  p->value = must_alloc((size_t)(p->begin[order] + 1) * sizeof *p->value);
  for (long n = 0; n < g->count; n++)
    for (long c = p->first[n]; c < p->first[n + 1]; c++) {
      int64_t *at = p->row + p->begin[c];
      for (long k = g->begin[n]; k < g->begin[n + 1]; k++)
        for (long r = p->first[g->near[k]]; r < p->first[g->near[k] + 1]; r++)
          *at++ = r;
    }
}

/* Row number `of` of each node of one colour; false where none has so many. */
static bool ask(const probe *p, const int32_t *colour, int32_t asked, long of, double *x) {
  bool some = false;
  for (long n = 0; n < p->g->count; n++)
    for (long r = p->first[n]; r < p->first[n + 1]; r++) {
      x[r] = colour[n] == asked && r - p->first[n] == of;
      some = some || x[r] > 0;
    }
  return some;
}

static void take(const probe *p, const double *x, const double *product) {
  for (long c = 0; c < p->first[p->g->count]; c++)
    for (int64_t k = p->begin[c]; x[c] > 0 && k < p->begin[c + 1]; k++)
      p->value[k] = product[p->row[k]];
}

static void ask_all(const probe *p, sparse_product *product, void *of) {
  const size_t order = (size_t)p->first[p->g->count] + 1;
  double *x = must_alloc(order * sizeof *x), *y = must_alloc(order * sizeof *y);
  int32_t colours, *colour = colours_of(p->g, &colours);
  for (int32_t c = 0; c < colours; c++)
    for (long row = 0; ask(p, colour, c, row, x); row++) {
      product(of, x, y);
      take(p, x, y);
    }
  free(colour);
  free(x);
  free(y);
}

static double value_at(const probe *p, int64_t row, int64_t column) {
  int64_t low = p->begin[column], high = p->begin[column + 1] - 1;
  while (low < high) {
    const int64_t middle = (low + high) / 2;
    if (p->row[middle] < row)
      low = middle + 1;
    else
      high = middle;
  }
  return p->value[low];
}

static void take_column(const probe *p, long c, sparse_matrix *m) {
  int64_t at = m->begin[c];
  for (int64_t k = p->begin[c]; k < p->begin[c + 1]; k++) {
    const int64_t r = p->row[k];
    if (r > c) break;
    const double there = value_at(p, c, r);
    m->row[at] = r;
    m->value[at++] = 0.5 * (p->value[k] + there);
    m->asymmetry = pl_fmax(m->asymmetry, fabs(p->value[k] - there));
  }
  m->begin[c + 1] = at;
}

static double largest_sum(const sparse_matrix *m) {
  double *sum = must_calloc((size_t)m->order + 1, sizeof *sum), most = 0;
  for (long c = 0; c < m->order; c++)
    for (int64_t k = m->begin[c]; k < m->begin[c + 1]; k++) {
      sum[m->row[k]] += fabs(m->value[k]);
      if (m->row[k] != c) sum[c] += fabs(m->value[k]);
    }
  for (long c = 0; c < m->order; c++) /* what is no number stays */
    most = sum[c] <= most ? most : sum[c];
  free(sum);
  return most;
}

sparse_matrix sparse_probe(const sparse_graph *g, const long *first, sparse_product *product,
                           void *of) {
  probe p = {.g = g, .first = first};
  const long order = first[g->count];
  lay_out(&p);
  ask_all(&p, product, of);
  const size_t most = (size_t)((p.begin[order] + order) / 2 + 1);
  sparse_matrix m = {.order = order,
                     .begin = must_calloc((size_t)order + 1, sizeof *m.begin),
                     .row = must_alloc(most * sizeof *m.row),
                     .value = must_alloc(most * sizeof *m.value)};
  for (long c = 0; c < order; c++)
    take_column(&p, c, &m);
  m.size = largest_sum(&m);
  free(p.begin);
  free(p.row);
  free(p.value);
  return m;
}

void sparse_multiply(const sparse_matrix *m, const double *x, double *product) {
  memset(product, 0, (size_t)m->order * sizeof *product);
  for (long c = 0; c < m->order; c++)
    for (int64_t k = m->begin[c]; k < m->begin[c + 1]; k++) {
      product[m->row[k]] += m->value[k] * x[c];
      if (m->row[k] != c) product[c] += m->value[k] * x[m->row[k]];
    }
}

void sparse_matrix_free(sparse_matrix *m) {
  free(m->begin);
  free(m->row);
  free(m->value);
}
