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
  integration_points_open(&c->points, &c->mesh);
  if (find_volumes(k, k->lattices[lattice].name, c, nodes, d)) return c;
  cells_free(c);
  return NULL;
}

void cells_free(cells *c) {
  if (!c) return;
  if (c->has_stencil) node_stencil_close(&c->stencil);
  if (c->has_matrix) node_matrix_close(&c->matrix);
  point_forces_free(c->by_points);
  integration_points_close(&c->points);
  mesh_close(&c->mesh);
  tips_free(c->tips);
  free(c);
}

static plane_stiffness tangent_at_rest(const cells *c, const double *parameters, bool viscous) {
  plane_stiffness k;
  point_forces_rest(&c->mesh, c->law, parameters, viscous, k.D);
  return k;
}

void cells_take_law(cells *c, const pl_law *law, const double *parameters) {
  c->law = law;
  c->stiffness = tangent_at_rest(c, parameters, false);
  c->has_stencil = law->linear && !c->mesh.lists;
  c->has_matrix = law->linear && c->mesh.lists;
  if (c->has_matrix) node_matrix_open(&c->matrix, &c->mesh, &c->points, &c->stiffness, NULL);
  if (c->has_stencil) node_stencil_open(&c->stencil, &c->mesh, &c->points, &c->stiffness, NULL);
}

/* The root of the largest eigenvalue of M^-1 K with that tangent at all points. */
static double highest(const cells *c, const plane_stiffness *law, const double *mass,
                      const unsigned char *held) {
  node_stencil k;
  if (c->mesh.lists) {
    node_matrix of;
    node_matrix_open(&of, &c->mesh, &c->points, law, NULL);
    const double omega = frequency_limit_of_matrix(&of, mass, held);
    node_matrix_close(&of);
    return omega;
  }
  node_stencil_open(&k, &c->mesh, &c->points, law, NULL);
  const double omega = frequency_limit(&k, mass, held);
  node_stencil_close(&k);
  return omega;
}

/* Of dt^2 omega^2 + 2 c dt <= 2/beta_1: what resists the strain rate does so half a step late. */
static double longest_step(double beta_1, double omega, double c) {
  return (2 / beta_1) / (c + sqrt(c * c + 2 / beta_1 * omega * omega));
}

void cells_step_limit(const cells *c, const double *parameters, const unsigned char *held,
                      step_limit *limit) {
  const size_t nodes = (size_t)mesh_node_count(&c->mesh);
  double *mass = must_calloc(nodes, sizeof *mass), damping = 0; /* none of nodes that are gone */
  unsigned char *held_nodes = must_calloc(2 * nodes, 1);
  for (long p = 0; p < c->nodes->particle_count; p++) {
    const int node = cells_node(c, c->nodes->particle_site[p]);
    mass[node] = c->nodes->site_mass[c->nodes->particle_site[p]];
    memcpy(held_nodes + 2 * node, held + 2 * p, 2);
  }
  const double omega = c->has_stencil  ? frequency_limit(&c->stencil, mass, held_nodes)
                       : c->has_matrix ? frequency_limit_of_matrix(&c->matrix, mass, held_nodes)
                                       : highest(c, &c->stiffness, mass, held_nodes);
  if (c->law->reads_rates) {
    const plane_stiffness viscosity = tangent_at_rest(c, parameters, true);
    const double root = highest(c, &viscosity, mass, held_nodes);
    damping = root * root;
  }
  *limit = (step_limit){.omega_max = omega, .mode = "translation"};
  if (omega > 0) {
    limit->limit = KEPT_BACK * longest_step(c->beta_1, omega, damping);
    limit->damping_ratio = 0.5 * damping / omega;
  }
  free(mass);
  free(held_nodes);
}

/* --- the engine ------------------------------------------------------------------------------- */

typedef struct cells_engine {
  cells *of;
  point_law *one;   /* of a linear law, to look at its outputs, */
  double *observed; /* which are these: [1 + outputs] */
  /* [size] N: K u of the present state and of the one before; what beta_1 adds to it, of both; the
     forces that move the nodes. Those of the present state change places with the last one's. */
  double *resisting[2], *before[2], *added[2], *added_before[2], *driving[2];
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

/* `seen`: not for a step. Rows of cells are shared out as rows of nodes are. */
static void find_resistance(sweep *w, int block, bool seen) {
  const body_block *b = &w->body->blocks[block];
  cells_engine *e = own(w);
  const point_motion motion = motion_of(w);
  if (e->of->by_points)
    point_forces_find(e->of->by_points, block, b->first, b->last, &motion, seen);
  else if (e->of->has_matrix)
    node_matrix_multiply(&e->of->matrix, motion.displacement, e->resisting, b->first, b->last);
  else
    node_stencil_multiply(&e->of->stencil, motion.displacement, e->resisting, b->first, b->last);
}

/* Points push nodes of several rows: what they push is added up when all have. */
static void take_resistance(const cells_engine *e, int row) {
  if (e->of->by_points) point_forces_take(e->of->by_points, row, e->resisting);
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
  if (e->of->by_points) point_forces_turn(e->of->by_points);
  if (e->of->tips) tips_after(e->of->tips, w->body, e->before, &e->of->mesh, &e->of->stencil);
}

/* Of a linear law. */
static double stored_in_row(const sweep *w, int row) {
  const cells_engine *e = own(w);
  const long start = body_start(w->body, row), count = w->body->count[row];
  double sum = 0;
  for (int d = 0; d < 2; d++)
    sum += 0.5 * lane_dot(count, NULL, e->resisting[d] + start, w->body->displacement[d] + start);
  return sum;
}

/* What is known of the points of the cells above a row of nodes. */
static point_row points_of_row(const sweep *w, int row) {
  const point_forces *p = own(w)->of->by_points;
  if (!p) return (point_row){.stored = stored_in_row(w, row)};
  return row < p->strips.rows ? p->rows[row] : (point_row){0};
}

/* Nodes have the means of the states of the points around them, and their part of what was lost. */
static void show_states(sweep *w, int row) {
  const point_forces *p = own(w)->of->by_points;
  const node_layout *l = &p->strips.layout;
  const long all = p->strips.count;
  for (int i = 0; i < l->nodes[0]; i++) {
    const int node = row * l->nodes[0] + i;
    if (p->of->gone[node]) continue;
    const long site = node_layout_at(l, node);
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
    if (e->of->by_points) show_states(w, r);
  }
}

static void observe(sweep *w, int stage, int block) {
  if (stage == 0)
    find_resistance(w, block, true);
  else
    observe_rows(w, block);
}

/* A plane of points at nodes: the means around, or their parts of what is stored. */
static void show(const sweep *w, const double *plane, bool part, double *values) {
  const point_forces *p = own(w)->of->by_points;
  memset(values, 0, (size_t)w->lattice->size * sizeof *values);
  for (long n = 0; n < w->lattice->particle_count; n++) {
    const long site = w->lattice->particle_site[n];
    const int node = node_layout_node(&p->strips.layout, site);
    values[site] = part ? point_forces_share(p, plane, node) : point_forces_mean(p, plane, node);
  }
}

/* Of a linear law half of the work of each node's resistance: together all that is stored. */
static void stored(sweep *w, double *values) {
  const cells_engine *e = own(w);
  if (e->of->by_points) {
    show(w, e->of->by_points->observed, true, values);
    return;
  }
  for (long q = 0; q < w->lattice->size; q++) {
    values[q] = 0;
    for (int d = 0; d < 2; d++)
      values[q] += 0.5 * e->resisting[d][q] * w->body->displacement[d][q];
  }
}

/* Of a linear law a point remembers nothing: asked for, it is looked at. */
static double output_at(const sweep *w, int number, int point) {
  const cells *c = own(w)->of;
  const double *at = c->points.at[point];
  point_shape s;
  double gradient[2][2], strain[3], *observed = own(w)->observed;
  shape_functions(&c->mesh, c->points.cell[point], at, &s);
  const node_layout l = node_layout_of(c->mesh.nodes, c->mesh.support);
  mesh_field(&s, &l, motion_of(w).displacement, NULL, gradient);
  mesh_strain(gradient, strain);
  point_law_observe(own(w)->one, strain, mesh_cell_size(&c->mesh, c->points.cell[point]), observed);
  return observed[1 + number];
}

/* Means over the points of the cells around the nodes. */
static void show_linear(const sweep *w, int number, double *values) {
  const cells *c = own(w)->of;
  const node_layout l = node_layout_of(c->mesh.nodes, c->mesh.support);
  double *area = must_calloc((size_t)w->lattice->size, sizeof *area);
  memset(values, 0, (size_t)w->lattice->size * sizeof *values);
  for (int n = 0; n < c->points.count; n++) {
    const double value = output_at(w, number, n);
    int corner[ELEMENT_MOST_NODES];
    const int corners = mesh_cell_nodes(&c->mesh, c->points.cell[n], corner);
    for (int k = 0; k < corners; k++) {
      const long site = node_layout_at(&l, corner[k]);
      values[site] += c->points.area[n] * value;
      area[site] += c->points.area[n];
    }
  }
  for (long q = 0; q < w->lattice->size; q++)
    if (area[q] > 0) values[q] /= area[q];
  free(area);
}

static void output(sweep *w, int number, double *values) {
  const point_forces *p = own(w)->of->by_points;
  if (p)
    show(w, p->observed + (1 + number) * (long)p->strips.count, false, values);
  else
    show_linear(w, number, values);
}

static void free_own(sweep *w) {
  point_law_free(own(w)->one);
  free(own(w)->observed);
  free(w->engine.own);
}

/* What asks points of the law: all of them in each step, or, of a linear law, now and then. */
static void open_points(sweep *w, cells_engine *e, const double *parameters) {
  cells *c = e->of;
  if (c->law->linear) {
    e->one = point_law_new(c->law, parameters);
    return;
  }
  c->by_points = point_forces_new(&c->mesh, &c->points, c->law, parameters, w->body->block_count,
                                  w->body->ledger);
  if (c->by_points->loses) sweep_new_losses(w);
}

sweep *cells_sweep(cells *c, const deck *k, const double *parameters, const tip_law *cracks,
                   double time_step, int threads, body_ledger ledger) {
  body *of = body_new(c->nodes, c->law->dof, time_step, threads, BODY_SHARE_ROWS);
  of->ledger = ledger != BODY_NO_LEDGER;
  of->forces = true;
  sweep *w = sweep_new(of, c->law, parameters, NULL);
  cells_engine *e = must_calloc(1, sizeof *e);
  e->of = c;
  for (int d = 0; d < 2; d++) {
    e->resisting[d] = body_doubles(of, c->nodes->size);
    e->before[d] = body_doubles(of, c->nodes->size);
    e->added[d] = body_doubles(of, c->nodes->size);
    e->added_before[d] = body_doubles(of, c->nodes->size);
    e->driving[d] = body_doubles(of, c->nodes->size);
  }
  e->row_rate = body_doubles(of, c->nodes->row_count);
  e->observed = must_calloc((size_t)c->law->output_count + 1, sizeof(double));
  open_points(w, e, parameters);
  if (c->tips)
    tips_take(c->tips, k, &c->stiffness, material_density(c->law, parameters), cracks, time_step);
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

cells_memory cells_remembered(const sweep *w) {
  cells_engine *e = own(w);
  const size_t plane = (size_t)w->lattice->size * sizeof(double),
               row = (size_t)w->lattice->row_count * sizeof(double);
  point_forces *p = e->of->by_points;
  const size_t points = p ? (size_t)p->strips.count * sizeof(double) : 0;
  cells_memory m = {
      .planes = {e->before[0], e->before[1], e->added_before[0], e->added_before[1], e->row_rate,
                 &e->begun, &e->of->stiffened},
      .bytes = {plane, plane, plane, plane, row, sizeof e->begun, sizeof e->of->stiffened}};
  m.count = CELLS_PLANES - 2;
  if (points && w->law->field_count > 0) {
    m.planes[m.count] = p->old_field;
    m.bytes[m.count++] = points * (size_t)w->law->field_count;
  }
  if (points && p->loses) {
    m.planes[m.count] = p->lost;
    m.bytes[m.count++] = points * PL_LOSSES;
  }
  return m;
}

void cells_restored(sweep *w) {
  cells *c = own(w)->of;
  if (c->tips) tips_replay(c->tips, &c->mesh, &c->stencil);
}

void cells_watch_stiffness(cells *c, double part, double time) {
  const point_forces *p = c->by_points;
  if (!p) return;
  c->stiffened.now = 0;
  for (int row = 0; row < p->strips.rows; row++)
    c->stiffened.now = pl_max(c->stiffened.now, p->rows[row].stiffness);
  c->stiffened.most = pl_max(c->stiffened.most, c->stiffened.now);
  const double rounding = 1e-6;
  if (c->stiffened.since < 0 && part * part * c->stiffened.now > 1 + rounding)
    c->stiffened.since = time;
}

bool cells_worst_point(const sweep *w, long site, point_state *out) {
  const body *of = w->body;
  point_forces *p = own(w)->of->by_points;
  if (!p) return false;
  double *before[2];
  for (int d = 0; d < 2; d++) {
    before[d] = must_calloc((size_t)w->lattice->size, sizeof(double));
    for (long n = 0; n < w->lattice->particle_count; n++) {
      const long q = w->lattice->particle_site[n];
      before[d][q] = of->displacement[d][q];
      if (body_has_moved(of, q) && isfinite(of->velocity[d][q]))
        before[d][q] -= of->time_step * of->velocity[d][q];
    }
  }
  point_motion motion = motion_of(w);
  motion.displacement = (const double *const *)before;
  point_forces_worst(p, node_layout_node(&p->strips.layout, site), &motion, out);
  free(before[0]);
  free(before[1]);
  return true;
}

bool cells_mean_stress(const cells *c, int node, double stress[4]) {
  const point_forces *p = c->by_points;
  for (int k = 0; k < PL_STRESSES(2) && p; k++)
    stress[k] = point_forces_mean(p, p->stress + k * (long)p->strips.count, node);
  return p != NULL;
}

bool cells_states_near(const cells *c, const double at[2], double *field) {
  const int cell = mesh_cell_of(&c->mesh, at);
  const point_forces *p = c->by_points;
  if (!p || cell < 0 || p->strips.of_cell[cell] < 0) return false;
  double least = INFINITY;
  for (int n = c->points.first[cell]; n < c->points.first[cell + 1]; n++) {
    const double away = pl_hypot(c->points.at[n][0] - at[0], c->points.at[n][1] - at[1]);
    if (!(away < least)) continue;
    least = away;
    const long first = p->strips.of_cell[cell] + (n - c->points.first[cell]) * PL_LANES;
    for (int f = 0; f < c->law->field_count; f++)
      field[f] = p->new_field[f * (long)p->strips.count + first];
  }
  return true;
}

double cells_bytes(const cells *c) {
  return (c->has_stencil ? (double)sizeof(double) * (double)c->stencil.block_count : 0) +
         (c->has_matrix ? (double)node_matrix_bytes(&c->matrix) : 0) +
         (c->by_points ? (double)point_forces_bytes(c->by_points) : 0);
}
