/* The plane mesh of a Gmsh file (gmsh_text.h): nodes of cells, cells, lines, and the physical
   groups of these. Nodes are numbered along a Hilbert curve, cells by their first nodes, so that
   what lies near each other stands near each other in memory; the file's own numbers are kept. */
#ifndef PERILAT_RUNTIME_GMSH_MESH_H
#define PERILAT_RUNTIME_GMSH_MESH_H

#include "dsl/base/arena.h"
#include "dsl/base/diagnostics.h"
#include "runtime/geometry/element.h"

typedef struct gmsh_group { /* with a name */
  const char *name;
  int dimension;          /* 0 points, 1 lines, 2 cells */
  span where;             /* of its name in the file */
  int32_t *nodes, *items; /* [node_count] ascending; [item_count] lines or cells */
  int node_count, item_count;
} gmsh_group;

typedef struct gmsh_side { /* a line of 2 or 3 nodes: from, to, perhaps the one between */
  int nodes;
  int32_t node[3];
  int cell;    /* of which it is a side: the one that has it from -> to; else the other; -1: none */
  bool turned; /* that cell has it the other way round */
} gmsh_side;

typedef struct gmsh_mesh {
  const char *path;
  int node_count, cell_count, side_count, group_count;
  double (*at)[2];      /* [nodes] m */
  int64_t *tag;         /* [nodes] the file's number */
  unsigned char *nodes; /* [cells] 3, 4 or 6 (element.h) */
  int32_t (*cell)[ELEMENT_MOST_NODES];
  int64_t *cell_tag;
  gmsh_side *sides;
  gmsh_group *groups;
  double least; /* m: the shortest side of a cell; of those with a node between half of it */
  double area;  /* m^2 */
} gmsh_mesh;

enum { GMSH_MOST_NODES = 4000000 };

/* Takes over `path` (malloc'ed), as gmsh_text_read. NULL after messages, also where a cell is
   degenerate or inverted, cells lie over each other (cell_overlap.h), a node hangs, or there is no
   cell. A surface all of whose cells are clockwise is turned. */
const gmsh_mesh *gmsh_mesh_read(arena *a, char *path, double unit, span where, diagnostics *d);

/* The group of that name; NULL without. */
const gmsh_group *gmsh_mesh_group(const gmsh_mesh *m, const char *name);

#endif
