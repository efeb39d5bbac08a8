/* The stiffness matrix of a linear law on a mesh of lists: 2 x 2 blocks, row by row, from every
   node to those that share a cell with it. Sums have one order: results do not depend on
   threads. */
#ifndef PERILAT_RUNTIME_NODE_MATRIX_H
#define PERILAT_RUNTIME_NODE_MATRIX_H

#include "runtime/continuum/node_stencil.h"

typedef struct node_matrix {
  node_layout layout;
  int nodes;              /* those that are there */
  int32_t *first, *other; /* [nodes + 1]; nodes that a block is for, ascending */
  int32_t *site;          /* of these in a plane of the layout */
  double (*block)[4];     /* N/m: xx, xy, yx, yy */
} node_matrix;

/* K = t sum B^T D B over the points; laws as in node_stencil.h. Nothing is kept of what is pointed
   at. */
void node_matrix_open(node_matrix *k, const mesh *m, const integration_points *p,
                      const plane_stiffness *laws, const unsigned char *law_of_cell);
/* Adds what quadrilaterals resist their hourglass modes by (element_modes.h). */
void node_matrix_resist_hourglass(node_matrix *k, const mesh *m, const plane_stiffness *laws,
                                  const unsigned char *law_of_cell);
void node_matrix_close(node_matrix *k);

/* f = K u for the rows of nodes from <= j < to. u, f: [2][layout.size]. */
void node_matrix_multiply(const node_matrix *k, const double *const u[2], double *const f[2],
                          int from, int to);
long node_matrix_bytes(const node_matrix *k);

#endif
