/* Cholesky's factors L L^T of a sparse symmetric matrix (CHOLMOD). Bits depend on the library. */
#ifndef PERILAT_RUNTIME_CHOLESKY_H
#define PERILAT_RUNTIME_CHOLESKY_H

#include <stdbool.h>
#include <stdint.h>

/* The upper triangle, by columns. */
typedef struct sparse_upper {
  long order;
  int64_t *begin; /* [order + 1] */
  int64_t *row;   /* ascending in each column */
  double *value;
} sparse_upper;

typedef enum cholesky_end { CHOLESKY_DONE, CHOLESKY_NOT_POSITIVE, CHOLESKY_NO_MEMORY } cholesky_end;

/* For matrices whose values stand where those of `a` do; NULL without memory. */
typedef struct cholesky cholesky;
cholesky *cholesky_new(const sparse_upper *a);
void cholesky_free(cholesky *f);

/* Of a + shift times 1. */
cholesky_end cholesky_factorise(cholesky *f, const sparse_upper *a, double shift);
/* Where the factors are of no use, in the order of elimination: the row that is not positive, or
   the first whose squared pivot is no more than that part of diagonal[order]; -1: nowhere. */
long cholesky_lost_row(const cholesky *f, const double *diagonal, double part);
/* x[order]: the right side; y[order]: the solution, or x itself. False without memory. */
bool cholesky_solve(cholesky *f, const double *x, double *y);

#endif
