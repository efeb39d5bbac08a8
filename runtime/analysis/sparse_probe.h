/* A sparse symmetric matrix from products with it: columns that have no row in common are asked for
   together (Curtis, Powell and Reid 1974).

       columns   1 2 3 1 2 3       columns of one number are asked for by one product
       row       x x . . . .
       row       x x x . . .       for a row of six particles with bonds to the next
       row       . x x x . .                                                            */
#ifndef PERILAT_RUNTIME_SPARSE_PROBE_H
#define PERILAT_RUNTIME_SPARSE_PROBE_H

#include <stdint.h>

/* Which nodes feel which: each itself, and both each other. */
typedef struct sparse_graph {
  long count;    /* nodes */
  long *begin;   /* [count + 1] in `near` */
  int32_t *near; /* ascending for each node */
} sparse_graph;

/* Of `count` pairs of nodes, in any order, each as often as may be. */
sparse_graph sparse_graph_new(long nodes, const int32_t (*pairs)[2], long count);
/* Those that are so many steps away from each other at most. */
sparse_graph sparse_graph_reach(const sparse_graph *g, int steps);
void sparse_graph_free(sparse_graph *g);

/* The upper triangle, by columns. */
typedef struct sparse_matrix {
  long order;
  int64_t *begin; /* [order + 1] */
  int64_t *row;   /* ascending in each column; the last one is the diagonal */
  double *value;
  double size;      /* largest sum of absolute values in a row: no eigenvalue is larger */
  double asymmetry; /* largest difference of two halves that should be equal */
} sparse_matrix;

/* product[order] = matrix times x[order] */
typedef void sparse_product(void *of, const double *x, double *product);

/* Node n has the rows first[n] .. first[n + 1] - 1. What the two halves say is averaged. */
sparse_matrix sparse_probe(const sparse_graph *g, const long *first, sparse_product *product,
                           void *of);
void sparse_multiply(const sparse_matrix *m, const double *x, double *product);
void sparse_matrix_free(sparse_matrix *m);

#endif
