#include "runtime/continuum/node_fields.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/continuum/point_law.h"
#include "runtime/mesh/mesh_fields.h"

static node_layout layout_of(const cells *c) {
  return node_layout_of(c->mesh.nodes, c->mesh.support);
}

void node_field_values(const cells *c, const double *const planes[2], double *values) {
  const node_layout l = layout_of(c);
  for (int n = 0; n < mesh_node_count(&c->mesh); n++) {
    const int32_t particle = c->nodes->site_particle[node_layout_at(&l, n)];
    int around[ELEMENT_MOST_AROUND];
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

enum { ANY_LAW = -1 };

/* Cells of a law around a node. */
static int cells_of_law(const cells *c, int law, int node, int around[ELEMENT_MOST_AROUND]) {
  const int count = mesh_cells_around(&c->mesh, node, around);
  int of_law = 0;
  for (int n = 0; n < count; n++)
    if (law == ANY_LAW || cell_laws_at(&c->where, around[n]) == law) around[of_law++] = around[n];
  return of_law;
}

/* Functions of element-free cells are the same in all of them: one speaks for all. */
static int cells_that_differ(const cells *c, int law, int node, int around[ELEMENT_MOST_AROUND]) {
  const mesh *m = &c->mesh;
  const int count = cells_of_law(c, law, node, around);
  bool alike = count > 0;
  for (int n = 0; n < count; n++)
    alike = alike && m->cell[around[n]] == CELL_ELEMENT_FREE;
  return alike ? 1 : count;
}

/* The mean over the cells of the law around the node; false: there are none. */
static bool strain_at(const cells *c, const node_layout *l, const double *const displacement[2],
                      int law, int node, double strain[3]) {
  int around[ELEMENT_MOST_AROUND];
  double there[2];
  const int count = cells_that_differ(c, law, node, around);
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
    cells_mean_dilatation(c, around[n], displacement, here);
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
    const bool known = strain_at(c, &l, displacement, ANY_LAW, n, here);
    for (int k = 0; k < 3; k++)
      strain[k][site] = known ? here[k] : NAN;
  }
}

/* Stress xx, yy, xy, zz of one law at a node. */
static void stress_of_law(const cells *c, point_law *const *laws, int law,
                          const double *const displacement[2], int node, double stress[4]) {
  const node_layout l = layout_of(c);
  double strain[3];
  int around[ELEMENT_MOST_AROUND];
  if (!cells_mean_stress(c, law, node, stress) &&
      strain_at(c, &l, displacement, law, node, strain) && cells_of_law(c, law, node, around) > 0)
    point_law_stress(laws[law], strain, mesh_cell_size(&c->mesh, around[0]), stress);
}

static void stress_at(const cells *c, point_law *const *laws, const double *const displacement[2],
                      int node, double stress[4]) {
  const long site = cells_site(c, node);
  const cell_laws *where = &c->where;
  if (where->count == 1) {
    stress_of_law(c, laws, 0, displacement, node, stress);
    return;
  }
  double sum[4] = {0};
  bool any = false;
  for (int n = 0; n < where->count; n++) {
    double here[4] = {NAN, NAN, NAN, NAN};
    if (!(where->share[n][site] > 0)) continue;
    stress_of_law(c, laws, n, displacement, node, here);
    any = true;
    for (int k = 0; k < 4; k++)
      sum[k] += where->share[n][site] * here[k];
  }
  if (any) memcpy(stress, sum, sizeof sum);
}

void node_field_stress(const cells *c, const double *const displacement[2],
                       double *const stress[3]) {
  const node_layout l = layout_of(c);
  const int count = c->where.count;
  point_law **laws = must_calloc((size_t)count, sizeof(point_law *));
  for (int n = 0; n < count; n++)
    laws[n] = point_law_new(c->laws[n].law, c->laws[n].parameters);
  for (int n = 0; n < mesh_node_count(&c->mesh); n++) {
    const long site = node_layout_at(&l, n);
    double here[4] = {NAN, NAN, NAN, NAN};
    if (c->nodes->site_particle[site] < 0) continue;
    stress_at(c, laws, displacement, n, here);
    for (int k = 0; k < 3; k++)
      stress[k][site] = here[k];
  }
  for (int n = 0; n < count; n++)
    point_law_free(laws[n]);
  free(laws);
}
