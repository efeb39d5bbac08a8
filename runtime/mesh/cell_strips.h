/* Points of integration side by side: PL_LANES cells of a row that have as many points each are a
   group, and a vector holds the same point of all of them. What acts at a point stands on a regular
   grid, so the nodes of neighbouring cells are neighbours in memory, and strains and forces are
   found by loops of unit stride without lists of nodes (a mesh of lists: element_strips.h):

       cells  c0  c1  c2 ...                 node at `offset` from the lower left corner of c0:
       point   0   0   0     lanes 0, 1, 2   displacement u[offset], u[offset + 1], u[offset + 2]
       point   1   1   1 */
#ifndef PERILAT_RUNTIME_CELL_STRIPS_H
#define PERILAT_RUNTIME_CELL_STRIPS_H

#include "runtime/mesh/element_strips.h"
#include "runtime/mesh/integration_points.h"
#include "runtime/mesh/node_layout.h"
#include "runtime/mesh/rectangle_cells.h"

/* What acts at the points of a group. Away from edges, zones and cracks it is the same in all cells
   (to rounding, 1e-11 of a slope) and stored once for all groups like it. */
typedef struct cell_table {
  int points;         /* of each cell */
  int lanes;          /* 1: the same in all cells of the group; else PL_LANES, one for each */
  int nodes, entries; /* nodes that act at some point; pairs of both */
  int *offset;        /* [nodes] doubles in a plane, from the lower left corner of the first cell */
  int *first;         /* [points + 1] entries of a point */
  int *away;          /* [entries] offset of the node */
  double *slope;      /* [entries][2][lanes] N_,x and N_,y, 1/m */
  int *first_of_node; /* [nodes + 1] of the two below */
  int *entry, *point; /* [entries] node by node */
  bool rectangle;     /* the same in all cells, bilinear rectangles with 2 x 2 points, of these */
  pl_rectangle slopes;
} cell_table;

typedef struct cell_group {
  int first, count; /* cells of its row: i of the first (of lists: number of the group); at most
                       PL_LANES */
  int points;       /* of each */
  int at;           /* place of its first point; PL_LANES for each point of a cell follow */
  const cell_table *table; /* NULL in a mesh of lists */
  double even;             /* m^3: of each point, where they are rectangles with the same; else 0 */
} cell_group;

typedef struct cell_strips {
  node_layout layout;
  int rows;           /* of cells */
  int *first_group;   /* [rows + 1] */
  int *first_point;   /* [rows + 1] places of points */
  cell_group *groups; /* [group_count] row by row */
  int group_count;
  int count;     /* places of points, those that fill vectors up included */
  int most;      /* of a group */
  int low, high; /* rows of nodes that a row of cells acts on: from j + low to j + high */
  element_strips *elements; /* of a mesh of lists; else NULL */
  double *volume;           /* [count] m^3; 0 of those that fill up */
  int *of_cell;        /* [cells] place of its first point, -1 without; the next is PL_LANES on */
  cell_table **tables; /* [table_count] */
  int table_count, table_room;
  long bytes; /* of it all */
} cell_strips;

/* Of the cells that own[cells] marks; NULL: of all. The mesh's cracks are those of now. */
void cell_strips_open(cell_strips *s, const mesh *m, const integration_points *p,
                      const unsigned char *own);
void cell_strips_close(cell_strips *s);

/* strain xx, yy, xy (of tensors) of the points of a group; u: planes laid out as `layout`;
   strain[3][points of the group]; 0 in what fills up. `row`: of cells. */
void cell_strips_strain(const cell_strips *s, int row, const cell_group *g,
                        const double *const u[2], double *const strain[3]);
/* Adds sum B^T t over the points of the group to the nodes' forces: traction[3][points of the
   group], stress xx, yy, xy times volume, N m; pushed[2]: what all groups push, cell_strips_pushed
   doubles, of which each row of cells has its own, 0 before. */
void cell_strips_push(const cell_strips *s, int row, const cell_group *g,
                      const double *const traction[3], double *const pushed[2]);
long cell_strips_pushed(const cell_strips *s);
/* The part gamma of quadrilaterals of a group in their nodes' motion along an axis, m, and forces
   along it that it adds: gamma[4][PL_LANES] in the order of element_hourglass, 0 where a cell has
   none; u: a plane of the layout; by[PL_LANES], N; pushed: one of cell_strips_push, which comes
   first. */
void cell_strips_mode(const cell_strips *s, int row, const cell_group *g, const double *gamma,
                      const double *u, double mode[PL_LANES]);
void cell_strips_push_mode(const cell_strips *s, int row, const cell_group *g, const double *gamma,
                           const double by[PL_LANES], double *pushed);
/* Whether all cells of a group are quadrilaterals with one point. */
bool cell_strips_single(const cell_strips *s, const cell_group *g);
/* Before a row of cells pushes. */
void cell_strips_clear(const cell_strips *s, int row, double *const pushed[2]);
/* N: the forces of a row of nodes, in planes of the layout; `more`: beside those that are there;
   `placed`: what the row of cells above does to them is there. */
void cell_strips_take(const cell_strips *s, int row, double *const pushed[2], bool placed,
                      bool more, double *const force[2]);
/* As cell_strips_push of `count` groups side by side that are alike and even, and full but for
   the last, from what each cell does to its nodes, N (rectangle_cells_push). */
void cell_strips_gather(const cell_strips *s, int row, const cell_group *g, int count,
                        double *const by_cell[RECTANGLE_PUSHES], double *const pushed[2]);
/* Adds forces of nodes of a row of cells, from number `first` on: low[count] and high[count], N. */
void cell_strips_add(const cell_strips *s, int row, int first, int count, const double *low,
                     const double *high, double *pushed);
/* Whether a row of cells is nothing but even groups, so that rectangle_rows sums what they do. */
bool cell_strips_is_whole(const cell_strips *s, int row);
/* What such a row does to its upper nodes, N: a row of `pushed`, one of cell_strips_push. */
double *cell_strips_pushed_row(const cell_strips *s, int row, double *pushed);

/* Number of a lane's cell; of what fills up the first one's. */
int cell_strips_cell(const cell_strips *s, const mesh *m, int row, const cell_group *g, int lane);
/* Whether the points of a lane's cell may push a node. */
bool cell_strips_reach(const cell_strips *s, const mesh *m, const cell_group *g, int lane,
                       int node);
/* Where the point at that place stands, m, and the lower left node of its cell; of lists the cell's
   number and -1. */
void cell_strips_place(const cell_strips *s, const mesh *m, const integration_points *p, int row,
                       const cell_group *g, int at, double place[2], int cell[2]);

#endif
