#include "runtime/continuum/cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/analysis/material.h"
#include "runtime/base/lane_sum.h"
#include "runtime/body/advance.h"
#include "runtime/body/motion.h"
#include "runtime/continuum/frequency_limit.h"
#include "runtime/continuum/mesh_build.h"
#include "runtime/continuum/node_masses.h"
#include "runtime/continuum/point_law.h"
#include "runtime/mesh/element_modes.h"
#include "runtime/mesh/mesh_fields.h"

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

static bool has_linear(const cells *c) {
  return c->has_stencil || c->has_matrix;
}

static bool all_linear(const cells *c) {
  for (int n = 0; n < c->where.count; n++)
    if (!c->laws[n].law->linear) return false;
  return true;
}

/* The root of the largest eigenvalue of M^-1 K with these tangents at the points of the laws' cells. */
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
  const double omega = !all_linear(c)  ? highest(c, c->stiffness, mass, held_nodes)
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

/* --- the engine ------------------------------------------------------------------------------- */

struct cells_engine;

/* A law at work on its cells. */
typedef struct cells_part {
  struct cells_engine *engine;
  int number;
  sweep *state;
  point_law *one;   /* of a linear law, to look at its outputs, */
  double *observed; /* which are these: [1 + outputs] */
} cells_part;

typedef struct cells_engine {
  cells *of;
  cells_part *parts; /* [of->where.count] */
  /* [size] N: what resists in the present state and in the one before; what beta_1 adds to it, of
     both; the forces that move the nodes. Those of the present state change places with the last
     one's. */
  double *resisting[2], *before[2], *added[2], *added_before[2], *driving[2];
  double *linear[2]; /* K u, where other laws resist, too; else NULL: all of `resisting` */
  double
      *row_rate; /* [row_count] J: taken by what beta_1 adds, up to the middle of the last step */
  bool begun;    /* there is a state before */
} cells_engine;

static cells_engine *own(const sweep *w) {
  return w->engine.own;
}

static point_motion motion_of(const sweep *w) {
  return (point_motion){(const double *const *)w->body->displacement,
                        (const double *const *)w->body->velocity, w->body->time,
                        w->body->time_step};
}

static double *const *linear_forces(const cells_engine *e) {
  return e->linear[0] ? e->linear : e->resisting;
}

/* `seen`: not for a step. Rows of cells are shared out as rows of nodes are. */
static void find_resistance(sweep *w, int block, bool seen) {
  const body_block *b = &w->body->blocks[block];
  const cells_engine *e = own(w);
  const cells *c = e->of;
  const point_motion motion = motion_of(w);
  if (c->has_stencil)
    node_stencil_multiply(&c->stencil, motion.displacement, linear_forces(e), b->first, b->last);
  if (c->has_matrix)
    node_matrix_multiply(&c->matrix, motion.displacement, linear_forces(e), b->first, b->last);
  for (int n = 0; n < c->where.count; n++)
    if (c->by_points[n])
      point_forces_find(c->by_points[n], block, b->first, b->last, &motion, seen);
}

/* Points push nodes of several rows: what they push is added up when all have. */
static void take_resistance(const cells_engine *e, int row) {
  const cells *c = e->of;
  bool more = e->linear[0] != NULL;
  for (int d = 0; d < 2 && more; d++) {
    const node_layout *l = c->has_matrix ? &c->matrix.layout : &c->stencil.layout;
    const long at = l->origin + row * l->stride;
    memcpy(e->resisting[d] + at, e->linear[d] + at, (size_t)l->padded * sizeof(double));
  }
  for (int n = 0; n < c->where.count; n++) {
    if (!c->by_points[n]) continue;
    point_forces_take(c->by_points[n], row, more, e->resisting);
    more = true;
  }
}

/* The forces that a row is kicked by. */
static void drive_row(sweep *w, int row, const double *force[PL_MAX_DOF]) {
  cells_engine *e = own(w);
  const long start = body_start(w->body, row), count = w->body->count[row];
  const double part = e->begun ? e->of->beta_1 - 0.5 : 0;
  for (int d = 0; d < 2; d++) {
    const double *now = e->resisting[d] + start, *last = e->before[d] + start;
    double *added = e->added[d] + start, *out = e->driving[d] + start,
           *felt = w->body->force[d] + start;
    INDEPENDENT
    for (long q = 0; q < count; q++) {
      added[q] = part * (now[q] - last[q]);
      out[q] = -(now[q] + added[q]);
      felt[q] = out[q];
    }
    force[d] = out;
  }
}

/* Work of what beta_1 adds over the way that led to the present state: half of it with the force
   before, half with the present one. */
static double taken_by_row(const sweep *w, int row) {
  const cells_engine *e = own(w);
  const long start = body_start(w->body, row), count = w->body->count[row];
  double sum = 0;
  for (int d = 0; d < 2 && e->of->beta_1 > 0.5; d++) {
    const double *velocity = w->body->velocity[d] + start;
    sum += lane_dot(count, NULL, e->added[d] + start, velocity) +
           lane_dot(count, NULL, e->added_before[d] + start, velocity);
  }
  return 0.5 * w->body->time_step * sum;
}

static void move_rows(sweep *w, int block) {
  body_block *b = &w->body->blocks[block];
  cells_engine *e = own(w);
  const double *force[PL_MAX_DOF];
  for (int r = b->first; r < b->last; r++) {
    take_resistance(e, r);
    drive_row(w, r, force);
    e->row_rate[r] += taken_by_row(w, r);
    advance_row(w->body, b, r, force);
  }
}

static void step(sweep *w, int stage, int block) {
  if (stage == 0) {
    body_step_begins(w->body, block);
    if (block == 0 && own(w)->of->tips)
      tips_before(own(w)->of->tips, w->body, &own(w)->of->stencil);
    find_resistance(w, block, false);
  } else {
    move_rows(w, block);
  }
}

static void exchange(double **a, double **b) {
  double *kept = *a;
  *a = *b;
  *b = kept;
}

/* The present state is the one before the next. */
static void turn(sweep *w) {
  cells_engine *e = own(w);
  for (int d = 0; d < 2; d++) {
    exchange(&e->before[d], &e->resisting[d]);
    exchange(&e->added_before[d], &e->added[d]);
  }
  e->begun = 1;
  for (int n = 0; n < e->of->where.count; n++)
    if (e->of->by_points[n]) point_forces_turn(e->of->by_points[n], w->body->time);
  if (e->of->tips) tips_after(e->of->tips, w->body, e->before, &e->of->mesh, &e->of->stencil);
}

/* Of linear laws. */
static double stored_in_row(const sweep *w, int row) {
  const cells_engine *e = own(w);
  const long start = body_start(w->body, row), count = w->body->count[row];
  double sum = 0;
  for (int d = 0; d < 2 && has_linear(e->of); d++)
    sum +=
        0.5 * lane_dot(count, NULL, linear_forces(e)[d] + start, w->body->displacement[d] + start);
  return sum;
}

/* What is known of the points of the cells above a row of nodes. */
static point_row points_of_row(const sweep *w, int row) {
  const cells *c = own(w)->of;
  point_row sum = {.stored = stored_in_row(w, row)};
  for (int n = 0; n < c->where.count; n++) {
    const point_forces *p = c->by_points[n];
    if (!p || row >= p->strips.rows) continue;
    sum.stored += p->rows[row].stored;
    sum.state += p->rows[row].state;
    sum.rate += p->rows[row].rate;
    sum.pending += p->rows[row].pending;
  }
  return sum;
}

/* Nodes have the means of the states of the points of the law around them, and their part of what was
   lost. */
static void show_states(const point_forces *p, const unsigned char *sites, sweep *w, int row) {
  const node_layout *l = &p->strips.layout;
  const long all = p->strips.count;
  for (int i = 0; i < l->nodes[0]; i++) {
    const int node = row * l->nodes[0] + i;
    const long site = node_layout_at(l, node);
    if (p->of->gone[node] || (sites && !sites[site])) continue;
    for (int f = 0; f < w->law->field_count; f++)
      w->new_field[f][site] = point_forces_mean(p, p->new_field + f * all, node);
    if (!p->loses) continue;
    double *const before[] = {w->dissipated_state, w->dissipated_rate}, *const now[] = {
                                                                            w->lost_state,
                                                                            w->lost_rate};
    for (int k = 0; k < PL_LOSSES; k++) {
      before[k][site] = point_forces_share(p, p->lost + k * all, node);
      now[k][site] = point_forces_share(p, p->lost_now + k * all, node);
    }
  }
}

static void show_all_states(const cells_engine *e, int row) {
  const cell_laws *where = &e->of->where;
  for (int n = 0; n < where->count; n++)
    if (e->of->by_points[n])
      show_states(e->of->by_points[n], where->sites ? where->sites[n] : NULL, e->parts[n].state,
                  row);
}

static void observe_rows(sweep *w, int block) {
  body_block *b = &w->body->blocks[block];
  const cells_engine *e = own(w);
  const double *force[PL_MAX_DOF];
  b->aside = true;
  for (int r = b->first; r < b->last; r++) {
    take_resistance(e, r);
    drive_row(w, r, force);
    advance_kick(w->body, b, r, force);
    motion_observe(w->body, b, r);
    body_row *seen = &w->body->observed[r];
    const point_row points = points_of_row(w, r);
    const double taken = taken_by_row(w, r);
    seen->stored = points.stored;
    seen->rate = e->row_rate[r] + taken + points.rate;
    seen->state = points.state + (r == 0 && e->of->tips ? e->of->tips->released : 0);
    seen->free += 0.5 * taken + points.pending;
    show_all_states(e, r);
  }
}

static void observe(sweep *w, int stage, int block) {
  if (stage == 0)
    find_resistance(w, block, true);
  else
    observe_rows(w, block);
}

/* A plane of points at nodes: the means around, or their parts of what is stored, added. */
static void show(const sweep *w, const point_forces *p, const double *plane, bool part,
                 double *values) {
  for (long n = 0; n < w->lattice->particle_count; n++) {
    const long site = w->lattice->particle_site[n];
    const int node = node_layout_node(&p->strips.layout, site);
    if (part)
      values[site] += point_forces_share(p, plane, node);
    else
      values[site] = point_forces_mean(p, plane, node);
  }
}

/* Of linear laws half of the work of each node's resistance: together all that is stored. */
static void stored(sweep *w, double *values) {
  const cells_engine *e = own(w);
  double *const *force = linear_forces(e);
  for (long q = 0; q < w->lattice->size; q++) {
    values[q] = 0;
    for (int d = 0; d < 2 && has_linear(e->of); d++)
      values[q] += 0.5 * force[d][q] * w->body->displacement[d][q];
  }
  for (int n = 0; n < e->of->where.count; n++) {
    const point_forces *p = e->of->by_points[n];
    if (p) show(w, p, p->observed, true, values);
  }
}

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

/* Of a linear law a point remembers nothing: asked for, it is looked at. J/m^3 stored, then outputs. */
static const double *look_at(const cells_part *of, int point) {
  const cells *c = of->engine->of;
  const double *at = c->points.at[point];
  point_shape s;
  double gradient[2][2], strain[3];
  shape_functions(&c->mesh, c->points.cell[point], at, &s);
  const node_layout l = node_layout_of(c->mesh.nodes, c->mesh.support);
  mesh_field(&s, &l, motion_of(of->state).displacement, NULL, gradient);
  mesh_strain(gradient, strain);
  cells_mean_dilatation(c, c->points.cell[point], motion_of(of->state).displacement, strain);
  point_law_observe(of->one, strain, mesh_cell_size(&c->mesh, c->points.cell[point]), of->observed);
  return of->observed;
}

/* Means over the points of the law's cells around the nodes. */
static void show_linear(const cells_part *of, int number, double *values) {
  const cells *c = of->engine->of;
  const node_layout l = node_layout_of(c->mesh.nodes, c->mesh.support);
  const rows *nodes = of->state->lattice;
  double *area = must_calloc((size_t)nodes->size, sizeof *area);
  for (int n = 0; n < c->points.count; n++) {
    int corner[ELEMENT_MOST_NODES];
    if (cell_laws_at(&c->where, c->points.cell[n]) != of->number) continue;
    const double value = look_at(of, n)[1 + number];
    const int corners = mesh_cell_nodes(&c->mesh, c->points.cell[n], corner);
    for (int k = 0; k < corners; k++) {
      const long site = node_layout_at(&l, corner[k]);
      values[site] += c->points.area[n] * value;
      area[site] += c->points.area[n];
    }
  }
  for (long q = 0; q < nodes->size; q++)
    if (area[q] > 0) values[q] /= area[q];
  free(area);
}

static void output_of(const cells_part *of, int number, double *values) {
  const point_forces *p = of->engine->of->by_points[of->number];
  memset(values, 0, (size_t)of->state->lattice->size * sizeof *values);
  if (p)
    show(of->state, p, p->observed + (1 + number) * (long)p->strips.count, false, values);
  else
    show_linear(of, number, values);
}

static void output(sweep *w, int number, double *values) {
  output_of(&own(w)->parts[0], number, values);
}

/* Of a law beside the first. */
static void output_beside(sweep *w, int number, double *values) {
  output_of(w->engine.own, number, values);
}

static void free_nothing(sweep *w) {
  (void)w;
}

static sweep_engine engine_beside(sweep *w, const double *parameters) {
  (void)w;
  (void)parameters;
  return (sweep_engine){.output = output_beside, .free = free_nothing};
}

static void free_own(sweep *w) {
  cells_engine *e = own(w);
  for (int n = 0; n < e->of->where.count; n++) {
    point_law_free(e->parts[n].one);
    free(e->parts[n].observed);
    if (n > 0) sweep_free(e->parts[n].state);
  }
  free(e->parts);
  free(e);
}

/* What asks points of the law: all of them in each step, or, of a linear law, now and then. */
static void open_points(cells *c, cells_part *part) {
  const cells_law *l = &c->laws[part->number];
  part->observed = must_calloc((size_t)l->law->output_count + 1, sizeof(double));
  if (l->law->linear) {
    part->one = point_law_new(l->law, l->parameters);
    return;
  }
  const body *of = part->state->body;
  point_forces *p = point_forces_new(&c->mesh, cell_laws_own(&c->where, part->number), &c->points,
                                     l->law, l->parameters, of->block_count, of->ledger);
  c->by_points[part->number] = p;
  if (p->loses) sweep_new_losses(part->state);
}

/* The first one moves the body. */
static void open_parts(cells_engine *e, sweep *first, sweep **states) {
  cells *c = e->of;
  e->parts = must_calloc((size_t)c->where.count, sizeof *e->parts);
  for (int n = 0; n < c->where.count; n++) {
    const cells_law *l = &c->laws[n];
    cells_part *part = &e->parts[n];
    *part = (cells_part){.engine = e, .number = n, .state = first};
    if (n > 0) {
      part->state = sweep_beside(first->body, c->nodes, l->law, l->parameters, NULL, engine_beside);
      part->state->engine.own = part;
    }
    part->state->share = c->where.share ? c->where.share[n] : NULL;
    states[n] = part->state;
    open_points(c, part);
  }
}

static void open_forces(cells_engine *e, body *of) {
  double **const planes[] = {e->resisting, e->before, e->added, e->added_before, e->driving};
  for (size_t k = 0; k < sizeof planes / sizeof *planes; k++)
    for (int d = 0; d < 2; d++)
      planes[k][d] = body_doubles(of, of->lattice->size);
  for (int d = 0; d < 2 && has_linear(e->of) && !all_linear(e->of); d++)
    e->linear[d] = body_doubles(of, of->lattice->size);
  e->row_rate = body_doubles(of, of->lattice->row_count);
}

sweep *cells_sweep(cells *c, const deck *k, const tip_law *cracks, double time_step, int threads,
                   body_ledger ledger, sweep **states) {
  const cells_law *first = &c->laws[0];
  body *of = body_new(c->nodes, first->law->dof, time_step, threads, BODY_SHARE_ROWS);
  of->ledger = ledger != BODY_NO_LEDGER;
  of->forces = true;
  sweep *w = sweep_new(of, first->law, first->parameters, NULL);
  cells_engine *e = must_calloc(1, sizeof *e);
  e->of = c;
  open_forces(e, of);
  open_parts(e, w, states);
  if (c->tips) {
    const int law = c->tips->law;
    tips_take(c->tips, k, &c->stiffness[law],
              material_density(c->laws[law].law, c->laws[law].parameters), cracks, time_step);
  }
  w->engine = (sweep_engine){.step_stages = 2,
                             .force_stages = 2,
                             .observe_stages = 2,
                             .step = step,
                             .forces = observe,
                             .turn = turn,
                             .observe = observe,
                             .output = output,
                             .stored = stored,
                             .free = free_own,
                             .own = e};
  return w;
}

/* --- what others ask -------------------------------------------------------------------------- */

void cells_look_at_tips(const sweep *w) {
  const cells *c = own(w)->of;
  if (c->tips) tips_at_rest(c->tips, w->body, &c->stencil);
}

static void remember(cells_memory *m, void *plane, size_t bytes) {
  m->planes = must_realloc(m->planes, ((size_t)m->count + 1) * sizeof *m->planes);
  m->bytes = must_realloc(m->bytes, ((size_t)m->count + 1) * sizeof *m->bytes);
  m->planes[m->count] = plane;
  m->bytes[m->count++] = bytes;
}

static void remember_points(cells_memory *m, point_forces *p) {
  const size_t points = (size_t)p->strips.count * sizeof(double);
  if (p->law->field_count > 0) remember(m, p->old_field, points * (size_t)p->law->field_count);
  if (p->loses) remember(m, p->lost, points * PL_LOSSES);
  if (p->failed >= 0) remember(m, &p->first_death, sizeof p->first_death);
}

cells_memory cells_remembered(const sweep *w) {
  cells_engine *e = own(w);
  const size_t plane = (size_t)w->lattice->size * sizeof(double);
  cells_memory m = {.count = 0};
  for (int d = 0; d < 2; d++)
    remember(&m, e->before[d], plane);
  for (int d = 0; d < 2; d++)
    remember(&m, e->added_before[d], plane);
  remember(&m, e->row_rate, (size_t)w->lattice->row_count * sizeof(double));
  remember(&m, &e->begun, sizeof e->begun);
  remember(&m, &e->of->stiffened, sizeof e->of->stiffened);
  for (int n = 0; n < e->of->where.count; n++)
    if (e->of->by_points[n]) remember_points(&m, e->of->by_points[n]);
  return m;
}

void cells_memory_free(cells_memory *m) {
  free(m->planes);
  free(m->bytes);
}

void cells_restored(sweep *w) {
  cells *c = own(w)->of;
  if (c->tips) tips_replay(c->tips, &c->mesh, &c->stencil);
}

void cells_watch_stiffness(cells *c, double part, double time) {
  if (all_linear(c)) return;
  c->stiffened.now = has_linear(c) ? 1 : 0;
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

/* Where the nodes were before the step that went wrong. */
static void find_before(const sweep *w, double *before[2]) {
  const body *of = w->body;
  for (int d = 0; d < 2; d++) {
    before[d] = must_calloc((size_t)w->lattice->size, sizeof(double));
    for (long n = 0; n < w->lattice->particle_count; n++) {
      const long q = w->lattice->particle_site[n];
      before[d][q] = of->displacement[d][q];
      if (body_has_moved(of, q) && isfinite(of->velocity[d][q]))
        before[d][q] -= of->time_step * of->velocity[d][q];
    }
  }
}

int cells_worst_point(const sweep *w, long site, point_state *out) {
  const cells *c = own(w)->of;
  double *before[2], *field = out->field, most = -1;
  int found = -1;
  point_motion motion = motion_of(w);
  find_before(w, before);
  motion.displacement = (const double *const *)before;
  for (int n = 0; n < c->where.count && !isnan(most); n++) {
    if (!c->by_points[n]) continue;
    const int fields = c->laws[n].law->field_count;
    point_state here = {.field = must_calloc((size_t)fields + 1, sizeof(double))};
    const double worst = point_forces_worst(c->by_points[n], cells_node(c, site), &motion, &here);
    if (isnan(worst) || worst > most) {
      memcpy(field, here.field, (size_t)fields * sizeof *field);
      free(here.field);
      here.field = field;
      *out = here;
      most = worst;
      found = n;
    } else {
      free(here.field);
    }
  }
  free(before[0]);
  free(before[1]);
  return found;
}

bool cells_mean_stress(const cells *c, int law, int node, double stress[4]) {
  const point_forces *p = c->by_points[law];
  for (int k = 0; k < PL_STRESSES(2) && p; k++)
    stress[k] = point_forces_mean(p, p->stress + k * (long)p->strips.count, node);
  return p != NULL;
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

/* J, in its hourglass modes. */
static double stored_in_modes(const cells_part *of, int cell) {
  const cells *c = of->engine->of;
  const double *const *u = motion_of(of->state).displacement;
  int node[ELEMENT_MOST_NODES];
  double gamma[4], sum = 0;
  const double part = element_hourglass(&c->mesh, cell, gamma);
  if (!(part > 0)) return 0;
  if (c->mesh.lists)
    mesh_cell_nodes(&c->mesh, cell, node);
  else
    mesh_corners(&c->mesh, cell, node);
  for (int d = 0; d < 2; d++) {
    double mode = 0;
    for (int q = 0; q < 4; q++)
      mode += gamma[q] * u[d][cells_site(c, node[q])];
    sum += mode * mode;
  }
  return 0.5 * c->mesh.thickness * part * element_strip_stiffness(c->stiffness[of->number].D) * sum;
}

/* Of a linear law beside others. */
static double stored_in_its_cells(const cells_part *of) {
  const cells *c = of->engine->of;
  double sum = 0;
  for (int cell = 0; cell < mesh_cell_count(&c->mesh); cell++) {
    if (cell_laws_at(&c->where, cell) != of->number) continue;
    for (int n = c->points.first[cell]; n < c->points.first[cell + 1]; n++)
      sum += c->mesh.thickness * c->points.area[n] * look_at(of, n)[0];
    sum += stored_in_modes(of, cell);
  }
  return sum;
}

double cells_stored_by(const sweep *law) {
  const cells_part *part = law->engine.own;
  const cells_engine *e = part->engine;
  const point_forces *p = e->of->by_points[part->number];
  double sum = 0;
  int linear = 0;
  for (int row = 0; p && row < p->strips.rows; row++)
    sum += p->rows[row].stored;
  if (p) return sum;
  for (int n = 0; n < e->of->where.count; n++)
    linear += e->of->laws[n].law->linear;
  if (linear > 1) return stored_in_its_cells(part);
  for (int row = 0; row < law->lattice->row_count; row++)
    sum += stored_in_row(e->parts[0].state, row);
  return sum;
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
