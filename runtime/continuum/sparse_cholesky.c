#include "runtime/continuum/sparse_cholesky.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

#include <cholmod.h>

struct sparse_cholesky {
  cholmod_common library;
  cholmod_factor *factor;
  cholmod_dense *in, *out, *work, *more_work;
  long order;
};

/* A pivot of that part of the diagonal is lost to rounding. */
static const double NO_PIVOT = 1e-12;

typedef struct upper { /* of the matrix, column by column */
  SuiteSparse_long *begin, *row;
  double *value, *diagonal;
} upper;

static void add_entry(upper *a, SuiteSparse_long *at, long row, double value) {
  a->row[*at] = row;
  a->value[(*at)++] = value;
}

/* Of a fixed freedom nothing but 1 on the diagonal. The matrix is symmetric: rows are columns. */
static upper upper_of(const node_matrix *k, const unsigned char *fixed) {
  const size_t order = 2 * (size_t)k->nodes, most = 4 * (size_t)k->first[k->nodes] + order + 1;
  upper a = {.begin = must_alloc((order + 1) * sizeof *a.begin),
             .row = must_alloc(most * sizeof *a.row),
             .value = must_alloc(most * sizeof *a.value),
             .diagonal = must_alloc((order + 1) * sizeof *a.diagonal)};
  SuiteSparse_long at = 0;
  for (long column = 0; column < 2L * k->nodes; column++) {
    const int node = (int)(column / 2), d = (int)(column % 2);
    a.begin[column] = at;
    a.diagonal[column] = 1;
    for (int32_t e = k->first[node]; e < k->first[node + 1] && !fixed[column]; e++)
      for (int c = 0; c < 2; c++) {
        const long row = 2L * k->other[e] + c;
        if (row > column || fixed[row]) continue;
        add_entry(&a, &at, row, k->block[e][2 * d + c]);
        if (row == column) a.diagonal[column] = k->block[e][2 * d + c];
      }
    if (fixed[column]) add_entry(&a, &at, column, 1);
  }
  a.begin[order] = at;
  return a;
}

static void upper_free(upper *a) {
  free(a->begin);
  free(a->row);
  free(a->value);
  free(a->diagonal);
}

static cholmod_sparse shown(const upper *a, long order) {
  return (cholmod_sparse){.nrow = (size_t)order,
                          .ncol = (size_t)order,
                          .nzmax = (size_t)a->begin[order],
                          .p = a->begin,
                          .i = a->row,
                          .x = a->value,
                          .stype = 1,
                          .itype = CHOLMOD_LONG,
                          .xtype = CHOLMOD_REAL,
                          .dtype = CHOLMOD_DOUBLE,
                          .sorted = 1,
                          .packed = 1};
}

/* pivot[order]: the diagonal of L; columns that have the same rows may be stored as one block. */
static void take_pivots(const cholmod_factor *l, double *pivot) {
  const double *value = l->x;
  const SuiteSparse_long *begin = l->p, *column = l->super, *rows = l->pi, *block = l->px;
  if (!l->is_super) {
    for (size_t k = 0; k < l->n; k++)
      pivot[k] = value[begin[k]]; /* the first of its column */
    return;
  }
  for (size_t b = 0; b < l->nsuper; b++)
    for (SuiteSparse_long k = column[b]; k < column[b + 1]; k++)
      pivot[k] = value[block[b] + (k - column[b]) * (rows[b + 1] - rows[b] + 1)];
}

/* The first freedom whose pivot is none; -1: all are good. */
static long lost_pivot(const sparse_cholesky *f, const double *diagonal) {
  const SuiteSparse_long *freedom = f->factor->Perm;
  double *pivot = must_calloc((size_t)f->order + 1, sizeof *pivot);
  long lost = -1;
  take_pivots(f->factor, pivot);
  for (long k = 0; k < f->order && lost < 0; k++)
    if (!(pivot[k] * pivot[k] > NO_PIVOT * diagonal[freedom[k]])) lost = freedom[k];
  free(pivot);
  return lost;
}

/* False where it is not positive, or there is no memory. */
static bool factorise(sparse_cholesky *f, upper *a, long *loose) {
  cholmod_sparse matrix = shown(a, f->order);
  *loose = -1;
  f->factor = cholmod_l_analyze(&matrix, &f->library);
  f->in = cholmod_l_zeros((size_t)f->order, 1, CHOLMOD_REAL, &f->library);
  if (!f->factor || !f->in) return false;
  cholmod_l_factorize(&matrix, f->factor, &f->library);
  if (f->library.status < CHOLMOD_OK) return false;
  if (f->library.status == CHOLMOD_NOT_POSDEF) {
    const size_t at = f->factor->minor;
    *loose = ((const SuiteSparse_long *)f->factor->Perm)[at < f->factor->n ? at : 0];
    return false;
  }
  *loose = lost_pivot(f, a->diagonal);
  return *loose < 0;
}

sparse_cholesky *sparse_cholesky_new(const node_matrix *k, const unsigned char *fixed,
                                     long *loose) {
  sparse_cholesky *f = must_calloc(1, sizeof *f);
  f->order = 2L * k->nodes;
  cholmod_l_start(&f->library);
  f->library.print = 0;
  f->library.quick_return_if_not_posdef = 1;
  f->library.final_ll = 1; /* which tells negative pivots */
  upper a = upper_of(k, fixed);
  const bool good = factorise(f, &a, loose);
  upper_free(&a);
  if (good) return f;
  sparse_cholesky_free(f);
  return NULL;
}

void sparse_cholesky_free(sparse_cholesky *f) {
  if (!f) return;
  cholmod_l_free_factor(&f->factor, &f->library);
  cholmod_l_free_dense(&f->in, &f->library);
  cholmod_l_free_dense(&f->out, &f->library);
  cholmod_l_free_dense(&f->work, &f->library);
  cholmod_l_free_dense(&f->more_work, &f->library);
  cholmod_l_finish(&f->library);
  free(f);
}

bool sparse_cholesky_solve(sparse_cholesky *f, double *x) {
  const size_t size = (size_t)f->order * sizeof *x;
  memcpy(f->in->x, x, size);
  if (!cholmod_l_solve2(CHOLMOD_A, f->factor, f->in, NULL, &f->out, NULL, &f->work, &f->more_work,
                        &f->library))
    return false;
  memcpy(x, f->out->x, size);
  return true;
}
