#include "runtime/continuum/cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/analysis/material.h"
#include "runtime/continuum/frequency_limit.h"
#include "runtime/continuum/mesh_build.h"
#include "runtime/continuum/node_masses.h"
#include "runtime/continuum/point_law.h"
#include "runtime/mesh/element_modes.h"
#include "runtime/mesh/shape_functions.h"

/* Power iteration finds the highest frequency from below. */
static const double KEPT_BACK = 0.98;

/* --- set-up ----------------------------------------------------------------------------------- */

long cells_site(const cells *c, int node) {
  const node_layout l = node_layout_of(c->mesh.nodes, c->mesh.support);
  return node_layout_at(&l, node);
}

int cells_node(const cells *c, long site) {
  const node_layout l = node_layout_of(c->mesh.nodes, c->mesh.support);
  return node_layout_node(&l, site);
}

int32_t cells_particle(const cells *c, int node) {
  return c->nodes->site_particle[cells_site(c, node)];
}

/* Where holes leave so few nodes that they bear no linear field. */
static void report_too_few(const deck *k, const char *name, const double at[2], diagnostics *d) {
  int n = 0;
  while (!k->notchs[n].mesh || strcmp(k->notchs[n].mesh, name) != 0)
    n++;
  diag_report(d, DIAG_NOT_SUPPORTED, k->notchs[n].item.where,
              "holes leave too few nodes of `%s` around (%.6g, %.6g) mm", name, 1e3 * at[0],
              1e3 * at[1]);
  diag_hint(d, "take more nodes, a wider `support`, or move the hole by a part of a spacing");
}

/* A point that no node acts at. */
static int lonely_point(const cells *c) {
  point_shape s;
  int n = 0;
  while (n < c->points.count) {
    shape_functions(&c->mesh, c->points.cell[n], c->points.at[n], &s);
    if (s.count == 0) break;
    n++;
  }
  return n;
}

/* Each node that is there has a volume, and together they have all of it. */
static bool nodes_bear(const deck *k, const char *name, const cells *c, const double *volume,
                       diagnostics *d) {
  const mesh *m = &c->mesh;
  double sum = 0, whole = 0, at[2];
  if (m->holes.count == 0) return true;
  for (int n = 0; n < mesh_node_count(m); n++) {
    if (m->gone[n]) continue;
    sum += volume[n];
    if (volume[n] > 0) continue;
    mesh_place(m, n, at);
    report_too_few(k, name, at, d);
    return false;
  }
  for (int n = 0; n < c->points.count; n++)
    whole += m->thickness * c->points.area[n];
  if (fabs(sum - whole) <= 1e-9 * whole) return true;
  const int lonely = lonely_point(c);
  report_too_few(k, name, c->points.at[lonely < c->points.count ? lonely : 0], d);
  return false;
}

/* Volumes of the nodes by the row sums, M = rho V: they sum to the mesh's. */
static bool find_volumes(const deck *k, const char *name, const cells *c, rows *nodes,
                         diagnostics *d) {
  const double density = 1;
  double *volume = must_calloc((size_t)mesh_node_count(&c->mesh), sizeof *volume);
  node_masses(&c->mesh, &c->points, &density, NULL, volume);
  const bool good = nodes_bear(k, name, c, volume, d);
  nodes->site_volume = rows_array(nodes->size, sizeof(double));
  nodes->site_mass = rows_array(nodes->size, sizeof(double));
  for (long q = 0; q < nodes->size; q++)
    nodes->site_volume[q] = nodes->volume; /* of absent sites, so that nothing is divided by 0 */
  for (long p = 0; p < nodes->particle_count && good; p++)
    nodes->site_volume[nodes->particle_site[p]] = volume[cells_node(c, nodes->particle_site[p])];
  free(volume);
  return good;
}

cells *cells_new(const deck *k, int lattice, rows *nodes, diagnostics *d) {
  cells *c = must_calloc(1, sizeof *c);
  c->nodes = nodes;
  c->beta_1 = k->newmark.beta_1;
  c->stiffened = (cells_stiffened){1, 1, -1};
  if (!mesh_build(k, lattice, &c->mesh, d)) {
    mesh_close(&c->mesh);
    free(c);
    return NULL;
  }
  if (!tips_new(k, k->lattices[lattice].name, &c->mesh, &c->tips, d)) {
    tips_free(c->tips);
    mesh_close(&c->mesh);
    free(c);
    return NULL;
  }
  if (!cell_laws_open(&c->where, k, lattice, nodes, &c->mesh, d)) {
    cells_free(c);
    return NULL;
  }
  integration_points_open(&c->points, &c->mesh);
  if (find_volumes(k, k->lattices[lattice].name, c, nodes, d)) return c;
  cells_free(c);
  return NULL;
}

void cells_free(cells *c) {
  if (!c) return;
  if (c->has_stencil) node_stencil_close(&c->stencil);
  if (c->has_matrix) node_matrix_close(&c->matrix);
  for (int n = 0; n < c->where.count && c->by_points; n++)
    point_forces_free(c->by_points[n]);
  free(c->by_points);
  free(c->laws);
  free(c->stiffness);
  free(c->linear);
  cell_laws_close(&c->where);
  integration_points_close(&c->points);
  mesh_close(&c->mesh);
  tips_free(c->tips);
  free(c);
}

static plane_stiffness tangent_at_rest(const cells *c, int law, bool viscous) {
  const cells_law *l = &c->laws[law];
  plane_stiffness k;
  point_forces_rest(&c->mesh, cell_laws_own(&c->where, law), l->law, l->parameters, viscous, k.D);
  return k;
}

/* Cells of laws that are not linear have no part in the stencil. */
static void find_linear(cells *c) {
  bool any = false;
  for (int n = 0; n < c->where.count; n++)
    any = any || c->laws[n].law->linear;
  c->has_stencil = any && !c->mesh.lists;
  c->has_matrix = any && c->mesh.lists;
  if (c->where.count == 1) return;
  c->linear = must_calloc((size_t)mesh_cell_count(&c->mesh) + 1, 1);
  for (int cell = 0; cell < mesh_cell_count(&c->mesh); cell++) {
    const int law = cell_laws_at(&c->where, cell);
    c->linear[cell] = c->laws[law].law->linear ? (unsigned char)law : NO_LINEAR_LAW;
  }
}

void cells_take_laws(cells *c, const cells_law *laws) {
  const size_t count = (size_t)c->where.count;
  c->laws = must_calloc(count, sizeof *c->laws);
  c->stiffness = must_calloc(count, sizeof *c->stiffness);
  c->by_points = must_calloc(count, sizeof *c->by_points);
  memcpy(c->laws, laws, count * sizeof *c->laws);
  for (int n = 0; n < c->where.count; n++)
    c->stiffness[n] = tangent_at_rest(c, n, false);
  find_linear(c);
  if (c->has_matrix) {
    node_matrix_open(&c->matrix, &c->mesh, &c->points, c->stiffness, c->linear);
    node_matrix_resist_hourglass(&c->matrix, &c->mesh, c->stiffness, c->linear);
  }
  if (!c->has_stencil) return;
  node_stencil_open(&c->stencil, &c->mesh, &c->points, c->stiffness, c->linear);
  node_stencil_resist_hourglass(&c->stencil);
}

void cells_densities(const cells *c, const double *density, double *at_site) {
  double *mass = must_calloc((size_t)mesh_node_count(&c->mesh), sizeof *mass);
  node_masses(&c->mesh, &c->points, density, c->where.of_cell, mass);
  for (long p = 0; p < c->nodes->particle_count; p++) {
    const long site = c->nodes->particle_site[p];
    at_site[site] = mass[cells_node(c, site)] / c->nodes->site_volume[site];
  }
  free(mass);
}

void cells_mark_pushed(const cells *c, unsigned char *node) {
  point_shape s;
  for (int n = 0; n < c->points.count; n++) {
    if (!c->linear || c->linear[c->points.cell[n]] != NO_LINEAR_LAW) continue;
    shape_functions(&c->mesh, c->points.cell[n], c->points.at[n], &s);
    for (int k = 0; k < s.count; k++)
      node[s.node[k]] = 1;
  }
}

bool cells_some_linear(const cells *c) {
  return c->has_stencil || c->has_matrix;
}

bool cells_all_linear(const cells *c) {
  for (int n = 0; n < c->where.count; n++)
    if (!c->laws[n].law->linear) return false;
  return true;
}

/* The root of the largest eigenvalue of M^-1 K with these tangents at the points of the laws'
   cells. */
static double highest(const cells *c, const plane_stiffness *laws, const double *mass,
                      const unsigned char *held) {
  node_stencil k;
  if (c->mesh.lists) {
    node_matrix of;
    node_matrix_open(&of, &c->mesh, &c->points, laws, c->where.of_cell);
    if (laws == c->stiffness) /* rates are not resisted so */
      node_matrix_resist_hourglass(&of, &c->mesh, laws, c->where.of_cell);
    const double omega = frequency_limit_of_matrix(&of, mass, held);
    node_matrix_close(&of);
    return omega;
  }
  node_stencil_open(&k, &c->mesh, &c->points, laws, c->where.of_cell);
  if (laws == c->stiffness) node_stencil_resist_hourglass(&k);
  const double omega = frequency_limit(&k, mass, held);
  node_stencil_close(&k);
  return omega;
}

/* The same with what resists the strain rate; 0: nothing does. */
static double highest_viscous(const cells *c, const double *mass, const unsigned char *held) {
  plane_stiffness *viscosity = must_calloc((size_t)c->where.count, sizeof *viscosity);
  bool any = false;
  for (int n = 0; n < c->where.count; n++) {
    if (!c->laws[n].law->reads_rates) continue;
    viscosity[n] = tangent_at_rest(c, n, true);
    any = true;
  }
  const double root = any ? highest(c, viscosity, mass, held) : 0;
  free(viscosity);
  return root;
}

/* Of dt^2 omega^2 + 2 c dt <= 2/beta_1: what resists the strain rate does so half a step late. */
static double longest_step(double beta_1, double omega, double c) {
  return (2 / beta_1) / (c + sqrt(c * c + 2 / beta_1 * omega * omega));
}

void cells_step_limit(const cells *c, const unsigned char *held, step_limit *limit) {
  const size_t nodes = (size_t)mesh_node_count(&c->mesh);
  double *mass = must_calloc(nodes, sizeof *mass); /* none of nodes that are gone */
  unsigned char *held_nodes = must_calloc(2 * nodes, 1);
  for (long p = 0; p < c->nodes->particle_count; p++) {
    const int node = cells_node(c, c->nodes->particle_site[p]);
    mass[node] = c->nodes->site_mass[c->nodes->particle_site[p]];
    memcpy(held_nodes + 2 * node, held + 2 * p, 2);
  }
  const double omega = !cells_all_linear(c) ? highest(c, c->stiffness, mass, held_nodes)
                       : c->has_matrix ? frequency_limit_of_matrix(&c->matrix, mass, held_nodes)
                                       : frequency_limit(&c->stencil, mass, held_nodes);
  const double root = highest_viscous(c, mass, held_nodes), damping = root * root;
  *limit = (step_limit){.omega_max = omega, .mode = "translation"};
  if (omega > 0) {
    limit->limit = KEPT_BACK * longest_step(c->beta_1, omega, damping);
    limit->damping_ratio = 0.5 * damping / omega;
  }
  free(mass);
  free(held_nodes);
}

/* --- what others ask -------------------------------------------------------------------------- */

void cells_mean_dilatation(const cells *c, int cell, const double *const displacement[2],
                           double strain[3]) {
  double mean[ELEMENT_MOST_NODES][2], theta = 0;
  if (!element_takes_mean(&c->mesh, cell)) return;
  point_shape s;
  shape_functions(&c->mesh, cell, c->points.at[c->points.first[cell]], &s);
  element_mean_gradient(&c->mesh, &c->points, cell, mean);
  for (int q = 0; q < s.count; q++)
    for (int d = 0; d < 2; d++)
      theta += mean[q][d] * displacement[d][cells_site(c, s.node[q])];
  const double shift = 0.5 * (theta - strain[0] - strain[1]);
  strain[0] += shift;
  strain[1] += shift;
}

void cells_watch_stiffness(cells *c, double part, double time) {
  if (cells_all_linear(c)) return;
  c->stiffened.now = cells_some_linear(c) ? 1 : 0;
  for (int n = 0; n < c->where.count; n++) {
    const point_forces *p = c->by_points[n];
    for (int row = 0; p && row < p->strips.rows; row++)
      c->stiffened.now = pl_max(c->stiffened.now, p->rows[row].stiffness);
  }
  c->stiffened.most = pl_max(c->stiffened.most, c->stiffened.now);
  const double rounding = 1e-6;
  if (c->stiffened.since < 0 && part * part * c->stiffened.now > 1 + rounding)
    c->stiffened.since = time;
}

bool cells_mean_stress(const cells *c, int law, int node, double stress[4]) {
  const point_forces *p = c->by_points[law];
  for (int k = 0; k < PL_STRESSES(2) && p; k++)
    stress[k] = point_forces_mean(p, p->stress + k * (long)p->strips.count, node);
  return p != NULL;
}

bool cells_whole(const cells *c, int cell) {
  int node[ELEMENT_MOST_NODES];
  bool whole = c->mesh.cell[cell] != CELL_ABSENT;
  const int count = mesh_cell_nodes(&c->mesh, cell, node);
  for (int k = 0; k < count; k++)
    whole = whole && cells_particle(c, node[k]) >= 0;
  return whole;
}

long cells_whole_count(const cells *c) {
  long count = 0;
  for (int cell = 0; cell < mesh_cell_count(&c->mesh); cell++)
    count += cells_whole(c, cell);
  return count;
}

/* Of a plane of the law's points. */
static void mean_in_cells(const cells *c, const point_forces *p, const double *plane,
                          double *values) {
  for (int cell = 0; cell < mesh_cell_count(&c->mesh); cell++) {
    if (!cells_whole(c, cell)) continue;
    if (point_forces_has(p, cell)) *values = point_forces_cell_mean(p, plane, cell);
    values++;
  }
}

void cells_mean_state(const cells *c, int law, int field, double *values) {
  const point_forces *p = c->by_points[law];
  if (p) mean_in_cells(c, p, p->new_field + field * (long)p->strips.count, values);
}

void cells_mean_output(const cells *c, int law, int output, double *values) {
  const point_forces *p = c->by_points[law];
  if (p) mean_in_cells(c, p, p->observed + (1 + output) * (long)p->strips.count, values);
}

bool cells_can_die(const cells *c) {
  for (int n = 0; n < c->where.count && c->laws; n++)
    if (point_law_failed(c->laws[n].law) >= 0) return true;
  return false;
}

bool cells_dead(const cells *c, int cell) {
  const point_forces *p = c->by_points[cell_laws_at(&c->where, cell)];
  return p && point_forces_dead(p, cell);
}

long cells_deaths(const cells *c, double *first) {
  long count = 0;
  *first = INFINITY;
  for (int n = 0; n < c->where.count; n++) {
    const point_forces *p = c->by_points[n];
    if (!p) continue;
    count += point_forces_deaths(p);
    if (p->first_death >= 0 && p->first_death < *first) *first = p->first_death;
  }
  return count;
}

bool cells_states_near(const cells *c, const double at[2], double *field) {
  const int cell = mesh_cell_of(&c->mesh, at);
  if (cell < 0) return false;
  const int law = cell_laws_at(&c->where, cell);
  const point_forces *p = c->by_points[law];
  if (!p || !point_forces_has(p, cell)) return false;
  double least = INFINITY;
  for (int n = c->points.first[cell]; n < c->points.first[cell + 1]; n++) {
    const double away = pl_hypot(c->points.at[n][0] - at[0], c->points.at[n][1] - at[1]);
    if (!(away < least)) continue;
    least = away;
    const long first = p->strips.of_cell[cell] + (n - c->points.first[cell]) * PL_LANES;
    for (int f = 0; f < p->law->field_count; f++)
      field[f] = p->new_field[f * (long)p->strips.count + first];
  }
  return true;
}

double cells_bytes(const cells *c) {
  double bytes = c->has_stencil ? (double)sizeof(double) * (double)c->stencil.block_count : 0;
  if (c->has_matrix) bytes += (double)node_matrix_bytes(&c->matrix);
  for (int n = 0; n < c->where.count; n++)
    if (c->by_points[n]) bytes += (double)point_forces_bytes(c->by_points[n]);
  return bytes;
}
