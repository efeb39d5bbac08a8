/* Points of integration of a mesh of lists, side by side: PL_LANES elements with as many nodes and
   points each are a group, and a vector holds the same point of all of them. Nodes stand anywhere,
   so each group has lists of them; what its elements push stands in a storage of its own, a slot
   for each node of each element:

       gather  u[site[node][lane]]   ->  strains, stresses (lanes)  ->  slot[node][lane]  ->  nodes

   A node takes what stands in its slots in the order of the groups: the same bits for any number of
   threads. */
#ifndef PERILAT_RUNTIME_ELEMENT_STRIPS_H
#define PERILAT_RUNTIME_ELEMENT_STRIPS_H

#include "runtime/kernel.h"
#include "runtime/mesh/integration_points.h"
#include "runtime/mesh/node_layout.h"

typedef struct element_group {
  int count, nodes, points; /* elements, at most PL_LANES; of each */
  int cell[PL_LANES];       /* what fills up has the first one's nodes */
  long slot;                /* of the first node and lane; PL_LANES of each node follow */
  long slope;               /* [points][nodes][2][PL_LANES] N_,x and N_,y, 1/m, from there on */
} element_group;

typedef struct element_strips {
  node_layout layout;
  int rows;         /* of elements: those whose first node is in that row of nodes */
  int *first_group; /* [rows + 1] */
  element_group *groups;
  int group_count;
  long slots, slopes;
  int32_t *site;     /* [slots] of the node in a plane of the layout */
  double *slope;     /* [slopes] */
  int nodes;         /* that are there */
  int32_t *first_of; /* [nodes + 1] slots of a node, */
  int32_t *slot_of;  /* these */
} element_strips;

/* Of the cells that own[cells] marks; NULL: of all. */
element_strips *element_strips_new(const mesh *m, const integration_points *p,
                                   const unsigned char *own);
void element_strips_free(element_strips *s);
long element_strips_bytes(const element_strips *s);

/* As cell_strips_strain and cell_strips_push; pushed[2][slots]. */
void element_strips_strain(const element_strips *s, int group, const double *const u[2],
                           double *const strain[3]);
void element_strips_push(const element_strips *s, int group, const double *const traction[3],
                         double *const pushed[2]);
/* sum_q gamma_q u_q of the elements of a group of quadrilaterals, m; and what this adds to the
   forces that the group pushes by: gamma[4][PL_LANES], 1; by[PL_LANES], N. */
void element_strips_mode(const element_strips *s, int group, const double *gamma, const double *u,
                         double mode[PL_LANES]);
void element_strips_push_mode(const element_strips *s, int group, const double *gamma,
                              const double by[PL_LANES], double *pushed);
/* The forces of a row of nodes; `more`: beside those that are there. */
void element_strips_take(const element_strips *s, int row, double *const pushed[2], bool more,
                         double *const force[2]);

#endif
