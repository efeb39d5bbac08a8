/* Cholesky's factors of a node_matrix, in which some freedoms are fixed. */
#ifndef PERILAT_RUNTIME_NODE_FACTORS_H
#define PERILAT_RUNTIME_NODE_FACTORS_H

#include "runtime/base/cholesky.h"
#include "runtime/continuum/node_matrix.h"

/* Freedom 2 n + d: direction d of node n; fixed[2 nodes]. NULL where the matrix is not positive,
   *loose being a freedom without stiffness; -1: there is not enough memory. */
cholesky *node_factors_new(const node_matrix *k, const unsigned char *fixed, long *loose);

#endif
