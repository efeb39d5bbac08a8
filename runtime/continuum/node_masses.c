#include "runtime/continuum/node_masses.h"

#include <string.h>

#include "runtime/mesh/shape_functions.h"

static void of_lists(const mesh *m, const double *density, const unsigned char *law_of_cell,
                     double *mass) {
  for (int c = 0; c < mesh_cell_count(m); c++) {
    const double part = density[law_of_cell ? law_of_cell[c] : 0] * m->thickness;
    double corner[ELEMENT_MOST_NODES][2], share[ELEMENT_MOST_NODES];
    cell_lists_places(m->lists, c, corner);
    element_mass(m->lists->nodes[c], (const double(*)[2])corner, share);
    for (int k = 0; k < m->lists->nodes[c]; k++)
      mass[m->lists->cell[c][k]] += part * share[k];
  }
}

void node_masses(const mesh *m, const integration_points *p, const double *density,
                 const unsigned char *law_of_cell, double *mass) {
  point_shape s;
  memset(mass, 0, (size_t)mesh_node_count(m) * sizeof *mass);
  if (m->lists) {
    of_lists(m, density, law_of_cell, mass);
    return;
  }
  for (int n = 0; n < p->count; n++) {
    const double rho = density[law_of_cell ? law_of_cell[p->cell[n]] : 0],
                 part = rho * m->thickness * p->area[n];
    shape_functions(m, p->cell[n], p->at[n], &s);
    for (int k = 0; k < s.count; k++)
      mass[s.node[k]] += part * s.n[k];
  }
}
