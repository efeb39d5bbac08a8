/* This room: meshes of nodes on a regular grid in the plane, what acts at a point of them, cracks
   that hide nodes from points, points of integration. It knows no deck and no law.

   A mesh is nodes[0] x nodes[1] nodes at equal spacings; node (i, j) has number j*nodes[0] + i, the
   cell to its upper right number j*(nodes[0] - 1) + i. Each node is one of finite elements or
   element-free, and a cell is what its corners are:

       o---o---o---o---x---x      o  finite elements    x  element-free
       | F | F | F | I | E |      F  bilinear element
       o---o---o---o---x---x      I  interface, blended (shape_functions.h)
       | F | F | I | E | E |      E  element-free cell
       o---o---o---x---x---x

   A mesh of elements alone may fill a quadrilateral: its nodes stand where the bilinear map
   (quadrilateral.h) takes those of equal spacings of the unit square. Within each cell the map is
   bilinear, too: the cells are isoparametric elements.

   A mesh of lists (cell_lists.h) has elements of any places: triangles, quadrilaterals, quadratic
   triangles. Its nodes are laid out in a grid of nodes[0] x nodes[1] as they come, so that all that
   goes by rows of nodes does; the last places are no nodes: `gone`.                              */
#ifndef PERILAT_RUNTIME_MESH_H
#define PERILAT_RUNTIME_MESH_H

#include <stdbool.h>

#include "dsl/base/c_linkage.h"
#include "runtime/geometry/quadrilateral.h"
#include "runtime/mesh/cell_lists.h"
#include "runtime/mesh/crack_lines.h"
#include "runtime/mesh/holes.h"

C_LINKAGE_BEGIN

typedef enum mesh_cell { CELL_ABSENT, CELL_ELEMENT, CELL_INTERFACE, CELL_ELEMENT_FREE } mesh_cell;

typedef struct mesh {
  int nodes[2];
  double corner[2], spacing[2]; /* m; mapped: of the box around it, and its size over the cells */
  bool mapped;                  /* it is a quadrilateral with */
  double corners[4][2];         /* m, counter-clockwise, the first that of node (0, 0) */
  cell_lists *lists;            /* nodes and cells of any places; NULL: a grid */
  double thickness;             /* m */
  double support;               /* d_max: half width of a node's support, in spacings; 1.5 to 5.5 */
  int gauss;        /* background rule of element-free and interface cells: gauss x gauss points */
  int gauss_parts;  /* in each of gauss_parts x gauss_parts equal parts of the cell */
  bool smooth_ramp; /* blending by 3R^2 - 2R^3 in place of R */
  /* Radius about the nearest live tip (m) within which sqrt(r) is in the basis; 0: nowhere */
  double enriched;
  crack_lines cracks;
  mesh_holes holes;             /* see cut_cells.h */
  unsigned char *gone;          /* [nodes] 1: in a hole, no node of the mesh */
  unsigned char *cut;           /* [cells] 1: a hole takes a part of it */
  unsigned char *element_free;  /* [nodes] 1: element-free, 0: of finite elements */
  unsigned char *moving;        /* [nodes] 1: has a moving least squares function */
  unsigned char *cell;          /* [cells] mesh_cell */
  unsigned char *element_gauss; /* [cells] rule of a bilinear element: 1 or 2 */
  /* [cells] of elements (element_modes.h): 1: with 2 x 2 points their dilatation is the mean; with
     one point they resist hourglass modes by that part of their stiffness */
  unsigned char *mean_dilatation;
  double *hourglass;
} mesh;

/* A mesh all of whose nodes are element-free, with 4 x 4 points a cell, without cracks. Memory is
   the mesh's. */
void mesh_open(mesh *m, const int nodes[2], const double corner[2], const double size[2],
               double thickness, double support);
void mesh_close(mesh *m);
/* The convex quadrilateral with these corners, of elements alone; `support` only tells how their
   values stand in memory. */
void mesh_open_mapped(mesh *m, const int nodes[2], const double corners[4][2], double thickness,
                      double support);
/* The mesh of these lists, which it takes over; nodes[0] nodes[1] >= l->node_count. `least`: m, the
   shortest side of a cell. */
void mesh_open_lists(mesh *m, const int nodes[2], cell_lists *l, double least, double thickness,
                     double support);
/* Once nodes are flagged: which cells are what, and which nodes have moving least squares. Absent
   cells stay so. */
void mesh_settle(mesh *m);

static inline int mesh_node_count(const mesh *m) {
  return m->nodes[0] * m->nodes[1];
}
static inline int mesh_cell_count(const mesh *m) {
  return m->lists ? m->lists->count : (m->nodes[0] - 1) * (m->nodes[1] - 1);
}
static inline int mesh_node(const mesh *m, int i, int j) {
  return j * m->nodes[0] + i;
}
static inline double mesh_at(const mesh *m, int axis, int k) {
  return m->corner[axis] + m->spacing[axis] * k;
}
/* Where node n stands. */
static inline void mesh_place(const mesh *m, int n, double at[2]) {
  const int i = n % m->nodes[0], j = n / m->nodes[0];
  if (m->lists) {
    const double *there = m->lists->at[n < m->lists->node_count ? n : m->lists->node_count - 1];
    at[0] = there[0];
    at[1] = there[1];
    return;
  }
  if (m->mapped) {
    const double u[2] = {(double)i / (m->nodes[0] - 1), (double)j / (m->nodes[1] - 1)};
    double slope[2][2];
    quadrilateral_map(m->corners, u, at, slope);
    return;
  }
  at[0] = mesh_at(m, 0, i);
  at[1] = mesh_at(m, 1, j);
}
/* Of a grid: number of the cell at place (i, j), and its corners: lower left and right, upper left
   and right. */
static inline int mesh_cell_at(const mesh *m, int i, int j) {
  return j * (m->nodes[0] - 1) + i;
}
static inline void mesh_corners(const mesh *m, int cell, int corner[4]) {
  const int i = cell % (m->nodes[0] - 1), j = cell / (m->nodes[0] - 1);
  corner[0] = mesh_node(m, i, j);
  corner[1] = corner[0] + 1;
  corner[2] = corner[0] + m->nodes[0];
  corner[3] = corner[2] + 1;
}
/* The order of these where corners are counted counter-clockwise, and the other way round: 0, 1, 3,
   2. */
static inline int mesh_corner_around(int q) {
  return q < 2 ? q : 5 - q;
}
/* Of any mesh: a cell's nodes, corners counter-clockwise, then those between. How many. */
int mesh_cell_nodes(const mesh *m, int cell, int node[ELEMENT_MOST_NODES]);
/* The cells around a node that are not absent, by their numbers: how many, of a grid 4 at most. */
int mesh_cells_around(const mesh *m, int node, int around[ELEMENT_MOST_AROUND]);
/* h, m: the root of the cell's area, of a triangle of 3 nodes of twice its area; holes included. */
double mesh_cell_size(const mesh *m, int cell);
/* How many times longer a quadrilateral is than wide, by means of opposite sides; 1 of
   triangles. */
double mesh_cell_slender(const mesh *m, int cell);
/* Where an element with one point knows the strain: its middle, whatever the place in it; what its
   corners do beside is no strain of the law's. Of other cells the place itself. */
void mesh_strain_place(const mesh *m, int cell, const double place[2], double at[2]);
/* The cell that holds a point (on a border: the one to its upper right, at the mesh's edge the
   last, another one where that is absent); -1 outside the mesh. */
int mesh_cell_of(const mesh *m, const double at[2]);

C_LINKAGE_END

#endif
