/* Do cells lie over each other? Nodes and middles of cells that lie inside of another cell, and
   nodes that hang: they lie on a side of a cell that has them not. Time grows as n log n. */
#ifndef PERILAT_RUNTIME_CELL_OVERLAP_H
#define PERILAT_RUNTIME_CELL_OVERLAP_H

#include <stdbool.h>
#include <stdint.h>

#include "runtime/geometry/element.h"

typedef struct overlap_cells {
  int node_count, count;
  const double (*at)[2];      /* [node_count] m */
  const unsigned char *nodes; /* [count] 3, 4 or 6 (element.h) */
  const int32_t (*cell)[ELEMENT_MOST_NODES];
  double same; /* m: nodes so near each other stand at one place, and do not hang */
} overlap_cells;

typedef struct cell_overlap {
  int cell;      /* in which it lies, or on whose side */
  int side;      /* from that corner on; -1: inside */
  int32_t node;  /* -1: the middle of */
  int32_t other; /* cell; -1 of a node */
} cell_overlap;

/* The first by the numbers of cells. Cells are sound (element_is_sound). */
bool cell_overlap_find(const overlap_cells *of, cell_overlap *found);

#endif
