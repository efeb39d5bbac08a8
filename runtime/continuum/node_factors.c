#include "runtime/continuum/node_factors.h"

#include <stdlib.h>

#include "dsl/base/arena.h"

/* A pivot of that part of the diagonal is lost to rounding. */
static const double NO_PIVOT = 1e-12;

static void add_entry(sparse_upper *a, int64_t *at, long row, double value) {
  a->row[*at] = row;
  a->value[(*at)++] = value;
}

/* Of a fixed freedom nothing but 1 on the diagonal. The matrix is symmetric: rows are columns. */
static sparse_upper upper_of(const node_matrix *k, const unsigned char *fixed, double *diagonal) {
  const size_t order = 2 * (size_t)k->nodes, most = 4 * (size_t)k->first[k->nodes] + order + 1;
  sparse_upper a = {.order = 2L * k->nodes,
                    .begin = must_alloc((order + 1) * sizeof *a.begin),
                    .row = must_alloc(most * sizeof *a.row),
                    .value = must_alloc(most * sizeof *a.value)};
  int64_t at = 0;
  for (long column = 0; column < a.order; column++) {
    const int node = (int)(column / 2), d = (int)(column % 2);
    a.begin[column] = at;
    diagonal[column] = 1;
    for (int32_t e = k->first[node]; e < k->first[node + 1] && !fixed[column]; e++)
      for (int c = 0; c < 2; c++) {
        const long row = 2L * k->other[e] + c;
        if (row > column || fixed[row]) continue;
        add_entry(&a, &at, row, k->block[e][2 * d + c]);
        if (row == column) diagonal[column] = k->block[e][2 * d + c];
      }
    if (fixed[column]) add_entry(&a, &at, column, 1);
  }
  a.begin[order] = at;
  return a;
}

cholesky *node_factors_new(const node_matrix *k, const unsigned char *fixed, long *loose) {
  double *diagonal = must_alloc((2 * (size_t)k->nodes + 1) * sizeof *diagonal);
  sparse_upper a = upper_of(k, fixed, diagonal);
  cholesky *f = cholesky_new(&a);
  const bool done = f && cholesky_factorise(f, &a, 0) != CHOLESKY_NO_MEMORY;
  *loose = done ? cholesky_lost_row(f, diagonal, NO_PIVOT) : -1;
  free(diagonal);
  free(a.begin);
  free(a.row);
  free(a.value);
  if (done && *loose < 0) return f;
  cholesky_free(f);
  return NULL;
}
