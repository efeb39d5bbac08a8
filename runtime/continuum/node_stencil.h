/* This room: what a mesh resists, weighs and bears. Here the stiffness matrix of a linear law, as 2
   x 2 blocks from every node to those around it.

   Two nodes interact when both act at some point: where they are at most m = ceil(2 d_max) - 1
   spacings apart along both axes (of bilinear elements alone m = 1). So each node has (2m + 1)^2
   blocks, whatever cracks hide: the matrix is a stencil that differs from node to node, needs no
   lists, and a product with it reads it once from end to end,

       f(i, j) = sum over dj, di = -m .. m of K(i, j; di, dj) u(i + di, j + dj).

   Blocks of PL_LANES neighbouring nodes of a row stand interleaved, so that the innermost loop is
   over nodes; rows are filled up to whole lanes. Vectors (node_vector) have one plane for each
   direction, with m rows and columns of zeros around.

   A crack that grows by a piece changes only points where a node acts that the piece hides: their
   old part is subtracted and a new one added (Karlsson 2006, 4.4, did all points again). Sums have
   one order: results do not depend on threads. */
#ifndef PERILAT_RUNTIME_NODE_STENCIL_H
#define PERILAT_RUNTIME_NODE_STENCIL_H

#include "runtime/base/pool.h"
#include "runtime/kernel.h"
#include "runtime/mesh/integration_points.h"
#include "runtime/mesh/moving_least_squares.h"
#include "runtime/mesh/node_layout.h"

/* Tangent of a cell's law in the plane, Pa: xx yy xy by xx yy xy, shears being those of
   engineers. */
typedef struct plane_stiffness {
  double D[3][3];
} plane_stiffness;

/* In law_of_cell: a cell whose law is none of these. */
enum { NO_LINEAR_LAW = 255 };

typedef struct node_stencil {
  node_layout layout;
  int reach; /* m of the blocks: 1 of bilinear elements alone */
  const mesh *of;
  const integration_points *points;
  const plane_stiffness *laws;      /* not owned */
  const unsigned char *law_of_cell; /* [cells] which of them, or NO_LINEAR_LAW; NULL: the first */
  pool *memory;
  double *blocks;
  long block_count; /* doubles */
  int blind;        /* points that ignore cracks, as too few nodes are left */
} node_stencil;

/* Assembles K = t sum B^T D B. What is pointed at must outlive the stencil. */
void node_stencil_open(node_stencil *k, const mesh *m, const integration_points *p,
                       const plane_stiffness *laws, const unsigned char *law_of_cell);
void node_stencil_close(node_stencil *k);
/* Adds what elements resist their hourglass modes by (element_modes.h). */
void node_stencil_resist_hourglass(node_stencil *k);

/* That of a cell; NULL: none. */
const plane_stiffness *node_stencil_law(const node_stencil *k, int cell);
/* Entry (a, b) of the block from `node` to `other`, N/m; 0 where they are too far apart. */
double node_stencil_entry(const node_stencil *k, int node, int other, int a, int b);

/* f = K u for the rows of nodes from <= j < to. u, f: [2][layout.size]. */
void node_stencil_multiply(const node_stencil *k, const double *const u[2], double *const f[2],
                           int from, int to);

/* Adds a -> b to the mesh's cracks, moves the live tip of that number to b (-1: none), and brings K
   up to date. Returns how many points changed. */
int node_stencil_grow(node_stencil *k, mesh *m, const double a[2], const double b[2], int tip);

#endif
