#include "runtime/continuum/node_fields.h"

#include <math.h>
#include <string.h>

#include "runtime/continuum/point_law.h"
#include "runtime/mesh/mesh_fields.h"

static node_layout layout_of(const cells *c) {
  return node_layout_of(c->mesh.nodes, c->mesh.support);
}

void node_field_values(const cells *c, const double *const planes[2], double *values) {
  const node_layout l = layout_of(c);
  for (int n = 0; n < mesh_node_count(&c->mesh); n++) {
    const int32_t particle = c->nodes->site_particle[node_layout_at(&l, n)];
    int around[MESH_MOST_AROUND];
    double at[2];
    point_shape s;
    if (particle < 0) continue;
    double *value = values + 2 * particle;
    value[0] = value[1] = NAN;
    mesh_place(&c->mesh, n, at);
    if (mesh_cells_around(&c->mesh, n, around) == 0) continue;
    shape_functions(&c->mesh, around[0], at, &s);
    mesh_field(&s, &l, planes, value, NULL);
  }
}

/* Functions of element-free cells are the same in all of them: one speaks for all. */
static int cells_that_differ(const mesh *m, int node, int around[MESH_MOST_AROUND]) {
  const int count = mesh_cells_around(m, node, around);
  bool alike = count > 0;
  for (int n = 0; n < count; n++)
    alike = alike && m->cell[around[n]] == CELL_ELEMENT_FREE;
  return alike ? 1 : count;
}

/* The mean over the cells around the node; false: there are none. */
static bool strain_at(const cells *c, const node_layout *l, const double *const displacement[2],
                      int node, double strain[3]) {
  int around[MESH_MOST_AROUND];
  double there[2];
  const int count = cells_that_differ(&c->mesh, node, around);
  mesh_place(&c->mesh, node, there);
  for (int k = 0; k < 3; k++)
    strain[k] = 0;
  for (int n = 0; n < count; n++) {
    point_shape s;
    double gradient[2][2], here[3], at[2];
    mesh_strain_place(&c->mesh, around[n], there, at);
    shape_functions(&c->mesh, around[n], at, &s);
    mesh_field(&s, l, displacement, NULL, gradient);
    mesh_strain(gradient, here);
    for (int k = 0; k < 3; k++)
      strain[k] += here[k] / count;
  }
  return count > 0;
}

void node_field_strain(const cells *c, const double *const displacement[2],
                       double *const strain[3]) {
  const node_layout l = layout_of(c);
  for (int n = 0; n < mesh_node_count(&c->mesh); n++) {
    const long site = node_layout_at(&l, n);
    double here[3];
    if (c->nodes->site_particle[site] < 0) continue;
    const bool known = strain_at(c, &l, displacement, n, here);
    for (int k = 0; k < 3; k++)
      strain[k][site] = known ? here[k] : NAN;
  }
}

void node_field_stress(const cells *c, const double *parameters,
                       const double *const displacement[2], double *const stress[3]) {
  const node_layout l = layout_of(c);
  point_law *law = point_law_new(c->law, parameters);
  for (int n = 0; n < mesh_node_count(&c->mesh); n++) {
    const long site = node_layout_at(&l, n);
    double strain[3], here[4] = {NAN, NAN, NAN, NAN};
    int around[MESH_MOST_AROUND];
    if (c->nodes->site_particle[site] < 0) continue;
    if (!cells_mean_stress(c, n, here) && strain_at(c, &l, displacement, n, strain) &&
        mesh_cells_around(&c->mesh, n, around) > 0)
      point_law_stress(law, strain, mesh_cell_size(&c->mesh, around[0]), here);
    for (int k = 0; k < 3; k++)
      stress[k][site] = here[k];
  }
  point_law_free(law);
}
