/* Where the values of a mesh's nodes stand in memory: node row by node row, each filled up to whole
   vectors of PL_LANES, with as many empty rows below and above, and empty places between rows, as
   nodes reach each other: m = ceil(2 d_max) - 1. So a loop over nodes reads its neighbours with
   unit stride and without asking where the mesh ends. */
#ifndef PERILAT_RUNTIME_NODE_LAYOUT_H
#define PERILAT_RUNTIME_NODE_LAYOUT_H

typedef struct node_layout {
  int nodes[2], reach;       /* m */
  long stride, origin, size; /* doubles: between rows, of node (0, 0), of a plane */
  long padded;               /* nodes of a row, filled up to PL_LANES */
} node_layout;

/* support: d_max. */
node_layout node_layout_of(const int nodes[2], double support);

static inline long node_layout_at(const node_layout *l, int node) {
  return l->origin + node / l->nodes[0] * l->stride + node % l->nodes[0];
}
/* The node that stands there. */
static inline int node_layout_node(const node_layout *l, long site) {
  const long row = (site - l->origin) / l->stride;
  return (int)(row * l->nodes[0] + (site - l->origin - row * l->stride));
}

#endif
