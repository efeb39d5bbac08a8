/* Displacements at rest under given forces: K u = F with some of them prescribed, by Cholesky's
   factors of the banded matrix (LAPACK), or of a sparse one (CHOLMOD). */
#ifndef PERILAT_RUNTIME_STATIC_SOLUTION_H
#define PERILAT_RUNTIME_STATIC_SOLUTION_H

#include "runtime/continuum/node_matrix.h"

typedef struct static_result {
  bool solved;     /* false: the matrix is not positive: something can move without force */
  int loose;       /* a node that can, where it is not solved */
  int loose_axis;  /* and along which axis */
  double residual; /* largest |K u - F| of free nodes over the largest force (or reaction) */
  double energy;   /* u K u/2, J */
} static_result;

/* Factors of K for one set of freedoms that are held, for any forces. NULL where the matrix is not
   positive, of which `r` says what is loose. */
typedef struct static_factors static_factors;
static_factors *static_factors_new(const node_stencil *k, const unsigned char *held,
                                   static_result *r);
static_factors *static_factors_of_matrix(const node_matrix *k, const unsigned char *held,
                                         static_result *r);
void static_factors_free(static_factors *f);
/* As static_solution. */
static_result static_factors_solve(const static_factors *f, const double *const force[2],
                                   double *const u[2], double *const reaction[2]);

/* u[d][n]: prescribed where held[2 n + d], else found; m. force[d][n]: N; reaction[d][n] = K u - F,
   which of free nodes is the residual. Nodes that no cell has stay where they are. */
static_result static_solution(const node_stencil *k, const unsigned char *held,
                              const double *const force[2], double *const u[2],
                              double *const reaction[2]);

#endif
