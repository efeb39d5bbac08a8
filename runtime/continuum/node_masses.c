#include "runtime/continuum/node_masses.h"

#include <string.h>

#include "runtime/mesh/shape_functions.h"

void node_masses(const mesh *m, const integration_points *p, const double *density,
                 const unsigned char *law_of_cell, double *mass) {
  point_shape s;
  memset(mass, 0, (size_t)mesh_node_count(m) * sizeof *mass);
  for (int n = 0; n < p->count; n++) {
    const double rho = density[law_of_cell ? law_of_cell[p->cell[n]] : 0],
                 part = rho * m->thickness * p->area[n];
    shape_functions(m, p->cell[n], p->at[n], &s);
    for (int k = 0; k < s.count; k++)
      mass[s.node[k]] += part * s.n[k];
  }
}
