/* Cholesky's factors of a node_matrix (CHOLMOD), in which some freedoms are fixed. */
#ifndef PERILAT_RUNTIME_SPARSE_CHOLESKY_H
#define PERILAT_RUNTIME_SPARSE_CHOLESKY_H

#include "runtime/continuum/node_matrix.h"

/* Freedom 2 n + d: direction d of node n. fixed[2 nodes]. NULL where the matrix is not positive, *loose
   being a freedom without stiffness; -1: there is not enough memory. */
typedef struct sparse_cholesky sparse_cholesky;
sparse_cholesky *sparse_cholesky_new(const node_matrix *k, const unsigned char *fixed, long *loose);
void sparse_cholesky_free(sparse_cholesky *f);
/* x[2 nodes]: the right side, then the solution. False without memory. */
bool sparse_cholesky_solve(sparse_cholesky *f, double *x);

#endif
