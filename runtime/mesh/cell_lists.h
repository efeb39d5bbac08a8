/* Nodes and cells in lists, as a mesh generator makes them: the cells around a node, the cell that
   holds a place. */
#ifndef PERILAT_RUNTIME_CELL_LISTS_H
#define PERILAT_RUNTIME_CELL_LISTS_H

#include <stdint.h>

#include "dsl/base/c_linkage.h"
#include "runtime/geometry/element.h"

C_LINKAGE_BEGIN

typedef int32_t cell_nodes[ELEMENT_MOST_NODES];

typedef struct cell_lists {
  int node_count, count;
  double (*at)[2];         /* [node_count] m */
  unsigned char *nodes;    /* [count] 3, 4 or 6 (element.h) */
  cell_nodes *cell;        /* [count] */
  int32_t *first, *around; /* [node_count + 1]; cells of a node in ascending order */
  double low[2], box;      /* m: of boxes of equal sides that hold all */
  int boxes[2];
  int64_t *first_in; /* [boxes + 1] */
  int32_t *in;       /* cells that may reach into a box, 16 for each cell at most in all */
} cell_lists;

/* Copies what it is given. */
cell_lists *cell_lists_new(int node_count, const double (*at)[2], int count,
                           const unsigned char *nodes, const cell_nodes *cell);
void cell_lists_free(cell_lists *l);

void cell_lists_places(const cell_lists *l, int cell, double place_of[ELEMENT_MOST_NODES][2]);
/* The cell that holds a place and where in it, the one of least number of several; -1: none. On the
   outline 1e-6 of a cell is near enough. */
int cell_lists_find(const cell_lists *l, const double at[2], double u[2]);

C_LINKAGE_END

#endif
