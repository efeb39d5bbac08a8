/* Points of integration: Gauss points of the cells of a mesh. An element has its own rule (1 x 1 or
   2 x 2), all other cells the background rule, in equal parts where that is asked for (Karlsson
   2006, 2.6); cells that a hole cuts as cut_cells.h says. */
#ifndef PERILAT_RUNTIME_INTEGRATION_POINTS_H
#define PERILAT_RUNTIME_INTEGRATION_POINTS_H

#include "runtime/mesh/gauss_rule.h"
#include "runtime/mesh/mesh.h"

typedef struct integration_points {
  int count;
  double (*at)[2]; /* [count] m */
  double *area;    /* [count] m^2 */
  int *cell;       /* [count] */
  int *first;      /* [cells + 1] points of a cell: first[c] .. first[c + 1] - 1 */
} integration_points;

void integration_points_open(integration_points *p, const mesh *m);
void integration_points_close(integration_points *p);

#endif
