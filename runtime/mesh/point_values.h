/* Values at the points of integration from values at the nodes, by the shape functions there: as
   displacements are found, so that what is linear stays linear. */
#ifndef PERILAT_RUNTIME_POINT_VALUES_H
#define PERILAT_RUNTIME_POINT_VALUES_H

#include "runtime/mesh/integration_points.h"

typedef struct point_values {
  long *first;  /* [points + 1] */
  int *node;    /* [first[points]] nodes that a point sees, */
  double *part; /* and the part of each */
} point_values;

void point_values_open(point_values *v, const mesh *m, const integration_points *p);
void point_values_close(point_values *v);
/* nodes[nodes of the mesh] */
double point_values_at(const point_values *v, int point, const double *nodes);

#endif
