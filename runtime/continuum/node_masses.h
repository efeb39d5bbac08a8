/* Masses of nodes, by the row sums of the consistent matrix: M_I = t sum rho w N_I over the points,
   as the functions sum to 1 (Karlsson 2006, 2.35); in lists as element.h says. Together they are
   the mesh's mass. */
#ifndef PERILAT_RUNTIME_NODE_MASSES_H
#define PERILAT_RUNTIME_NODE_MASSES_H

#include "runtime/mesh/integration_points.h"

/* mass[nodes], kg; density[laws] kg/m^3 by law_of_cell (NULL: the first). */
void node_masses(const mesh *m, const integration_points *p, const double *density,
                 const unsigned char *law_of_cell, double *mass);

#endif
