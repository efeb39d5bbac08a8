#include "runtime/continuum/cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/analysis/material.h"
#include "runtime/base/lane_sum.h"
#include "runtime/body/advance.h"
#include "runtime/body/motion.h"
#include "runtime/continuum/frequency_limit.h"
#include "runtime/continuum/mesh_build.h"
#include "runtime/continuum/node_masses.h"
#include "runtime/continuum/point_law.h"
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
static void report_too_few(const deck *k, const double at[2], diagnostics *d) {
  int n = 0;
  while (!k->notchs[n].mesh)
    n++;
  diag_report(d, DIAG_NOT_SUPPORTED, k->notchs[n].item.where,
              "holes leave too few nodes around (%.6g, %.6g) mm", 1e3 * at[0], 1e3 * at[1]);
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

static bool nodes_bear(const deck *k, const cells *c, const double *volume, diagnostics *d) {
  const mesh *m = &c->mesh;
  double sum = 0, whole = 0, at[2];
  if (m->holes.count == 0) return true;
  for (int n = 0; n < mesh_node_count(m); n++) {
    sum += volume[n];
    if (m->gone[n] || volume[n] > 0) continue;
    mesh_place(m, n, at);
    report_too_few(k, at, d);
    return false;
  }
  for (int n = 0; n < c->points.count; n++)
    whole += m->thickness * c->points.area[n];
  if (fabs(sum - whole) <= 1e-9 * whole) return true;
  const int lonely = lonely_point(c);
  report_too_few(k, c->points.at[lonely < c->points.count ? lonely : 0], d);
  return false;
}

/* Volumes of the nodes by the row sums, M = rho V: they sum to the mesh's. */
static bool find_volumes(const deck *k, const cells *c, rows *nodes, diagnostics *d) {
  const double density = 1;
  double *volume = must_calloc((size_t)mesh_node_count(&c->mesh), sizeof *volume);
  node_masses(&c->mesh, &c->points, &density, NULL, volume);
  const bool good = nodes_bear(k, c, volume, d);
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
  if (find_volumes(k, c, nodes, d)) return c;
  cells_free(c);
  return NULL;
}

void cells_free(cells *c) {
  if (!c) return;
  if (c->has_stencil) node_stencil_close(&c->stencil);
  integration_points_close(&c->points);
  mesh_close(&c->mesh);
  tips_free(c->tips);
  free(c);
}

/* The law's tangent at rest. */
static plane_stiffness tangent_at_rest(const pl_law *law, const double *parameters) {
  const double rest[3] = {0};
  plane_stiffness k;
  point_law *p = point_law_new(law, parameters);
  point_law_tangent(p, rest, 1, k.D);
  point_law_free(p);
  return k;
}

void cells_take_law(cells *c, const pl_law *law, const double *parameters) {
  c->law = law;
  c->stiffness = tangent_at_rest(law, parameters);
  node_stencil_open(&c->stencil, &c->mesh, &c->points, &c->stiffness, NULL);
  c->has_stencil = true;
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
  const double omega = frequency_limit(&c->stencil, mass, held_nodes);
  *limit = (step_limit){.omega_max = omega, .mode = "translation"};
  if (omega > 0) limit->limit = KEPT_BACK * sqrt(2 / c->beta_1) / omega;
  free(mass);
  free(held_nodes);
}

/* --- the engine ------------------------------------------------------------------------------- */

typedef struct cells_engine {
  cells *of;
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

static void find_resistance(sweep *w, int block) {
  const body_block *b = &w->body->blocks[block];
  cells_engine *e = own(w);
  node_stencil_multiply(&e->of->stencil, (const double *const *)w->body->displacement, e->resisting,
                        b->first, b->last);
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
    find_resistance(w, block);
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
  if (e->of->tips) tips_after(e->of->tips, w->body, e->before, &e->of->mesh, &e->of->stencil);
}

static void observe_rows(sweep *w, int block) {
  body_block *b = &w->body->blocks[block];
  const cells_engine *e = own(w);
  const double *force[PL_MAX_DOF];
  b->aside = true;
  for (int r = b->first; r < b->last; r++) {
    const long start = body_start(w->body, r), count = w->body->count[r];
    drive_row(w, r, force);
    advance_kick(w->body, b, r, force);
    motion_observe(w->body, b, r);
    body_row *seen = &w->body->observed[r];
    seen->stored = 0;
    for (int d = 0; d < 2; d++)
      seen->stored +=
          0.5 * lane_dot(count, NULL, e->resisting[d] + start, w->body->displacement[d] + start);
    const double taken = taken_by_row(w, r);
    seen->rate = e->row_rate[r] + taken;
    seen->state = r == 0 && e->of->tips ? e->of->tips->released : 0;
    seen->free += 0.5 * taken;
  }
}

static void observe(sweep *w, int stage, int block) {
  if (stage == 0)
    find_resistance(w, block);
  else
    observe_rows(w, block);
}

/* Half of the work of each node's resistance: together all that is stored. */
static void stored(sweep *w, double *values) {
  const cells_engine *e = own(w);
  for (long q = 0; q < w->lattice->size; q++) {
    values[q] = 0;
    for (int d = 0; d < 2; d++)
      values[q] += 0.5 * e->resisting[d][q] * w->body->displacement[d][q];
  }
}

static void output(sweep *w, int number, double *values) {
  (void)number;
  memset(values, 0, (size_t)w->lattice->size * sizeof *values);
}

static void free_own(sweep *w) {
  free(w->engine.own);
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

void cells_look(const sweep *w) {
  const cells *c = own(w)->of;
  if (c->tips) tips_at_rest(c->tips, w->body, &c->stencil);
}

cells_memory cells_remembered(const sweep *w) {
  cells_engine *e = own(w);
  const size_t plane = (size_t)w->lattice->size * sizeof(double);
  return (cells_memory){
      CELLS_PLANES,
      {e->before[0], e->before[1], e->added_before[0], e->added_before[1], e->row_rate, &e->begun},
      {plane, plane, plane, plane, (size_t)w->lattice->row_count * sizeof(double),
       sizeof e->begun}};
}

void cells_restored(sweep *w) {
  cells *c = own(w)->of;
  if (c->tips) tips_replay(c->tips, &c->mesh, &c->stencil);
}
