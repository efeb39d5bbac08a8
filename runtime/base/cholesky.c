#include "runtime/base/cholesky.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

#include <cholmod.h>

struct cholesky {
  cholmod_common library;
  cholmod_factor *factor;
  cholmod_dense *in, *out, *work, *more_work;
};

static cholmod_sparse shown(const sparse_upper *a) {
  return (cholmod_sparse){.nrow = (size_t)a->order,
                          .ncol = (size_t)a->order,
                          .nzmax = (size_t)a->begin[a->order],
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

cholesky *cholesky_new(const sparse_upper *a) {
  cholesky *f = must_calloc(1, sizeof *f);
  cholmod_sparse matrix = shown(a);
  cholmod_l_start(&f->library);
  f->library.print = 0;
  f->library.quick_return_if_not_posdef = 1;
  f->library.final_ll = 1; /* which tells negative pivots */
  f->factor = cholmod_l_analyze(&matrix, &f->library);
  f->in = cholmod_l_zeros(matrix.nrow, 1, CHOLMOD_REAL, &f->library);
  if (f->factor && f->in) return f;
  cholesky_free(f);
  return NULL;
}

void cholesky_free(cholesky *f) {
  if (!f) return;
  cholmod_l_free_factor(&f->factor, &f->library);
  cholmod_l_free_dense(&f->in, &f->library);
  cholmod_l_free_dense(&f->out, &f->library);
  cholmod_l_free_dense(&f->work, &f->library);
  cholmod_l_free_dense(&f->more_work, &f->library);
  cholmod_l_finish(&f->library);
  free(f);
}

cholesky_end cholesky_factorise(cholesky *f, const sparse_upper *a, double shift) {
  cholmod_sparse matrix = shown(a);
  double beta[2] = {shift, 0};
  f->library.status = CHOLMOD_OK;
  cholmod_l_factorize_p(&matrix, beta, NULL, 0, f->factor, &f->library);
  if (f->library.status < CHOLMOD_OK) return CHOLESKY_NO_MEMORY;
  return f->library.status == CHOLMOD_OK ? CHOLESKY_DONE : CHOLESKY_NOT_POSITIVE;
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

long cholesky_lost_row(const cholesky *f, const double *diagonal, double part) {
  const cholmod_factor *l = f->factor;
  const SuiteSparse_long *row = l->Perm;
  if (l->minor < l->n) return row[l->minor];
  double *pivot = must_calloc(l->n + 1, sizeof *pivot);
  long lost = -1;
  take_pivots(l, pivot);
  for (size_t k = 0; k < l->n && lost < 0; k++)
    if (!(pivot[k] * pivot[k] > part * diagonal[row[k]])) lost = row[k];
  free(pivot);
  return lost;
}

bool cholesky_solve(cholesky *f, const double *x, double *y) {
  const size_t size = f->factor->n * sizeof *x;
  memcpy(f->in->x, x, size);
  if (!cholmod_l_solve2(CHOLMOD_A, f->factor, f->in, NULL, &f->out, NULL, &f->work, &f->more_work,
                        &f->library))
    return false;
  memcpy(y, f->out->x, size);
  return true;
}
