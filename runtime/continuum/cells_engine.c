#include "runtime/continuum/cells_engine.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/analysis/material.h"
#include "runtime/base/lane_sum.h"
#include "runtime/body/advance.h"
#include "runtime/body/motion.h"
#include "runtime/continuum/point_law.h"
#include "runtime/mesh/element_modes.h"
#include "runtime/mesh/mesh_fields.h"

/* --- a step ----------------------------------------------------------------------------------- */

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
  double *nodes; /* [nodes] of what is given by node */
} cells_engine;

static cells_engine *own(const sweep *w) {
  return w->engine.own;
}

static point_motion motion_of(const sweep *w) {
  return (point_motion){(const double *const *)w->body->displacement,
                        (const double *const *)w->body->velocity, w->body->time,
                        w->body->time_step, w->body->advance};
}

static double *const *linear_forces(const cells_engine *e) {
  return e->linear[0] ? e->linear : e->resisting;
}

/* Whether all that resists are the points of one law. */
static bool is_alone(const cells_engine *e) {
  return e->of->where.count == 1 && !cells_some_linear(e->of);
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
      point_forces_find(c->by_points[n], block, b->first, b->last, &motion, seen,
                        is_alone(e) ? e->resisting : NULL);
}

/* Points push nodes of several rows: what they push and is not summed yet is added up when all
   have. */
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

/* --- what is observed ------------------------------------------------------------------------- */

/* Of linear laws. */
static double stored_in_row(const sweep *w, int row) {
  const cells_engine *e = own(w);
  const long start = body_start(w->body, row), count = w->body->count[row];
  double sum = 0;
  for (int d = 0; d < 2 && cells_some_linear(e->of); d++)
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
    sum.given += p->rows[row].given;
    sum.pending += p->rows[row].pending;
  }
  return sum;
}

/* Nodes have the means of the states of the points of the law around them, and their part of what
   was lost. */
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
    for (int k = 0; k < 2; k++) {
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
    seen->given = points.given;
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

/* --- what nodes show -------------------------------------------------------------------------- */

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
    for (int d = 0; d < 2 && cells_some_linear(e->of); d++)
      values[q] += 0.5 * force[d][q] * w->body->displacement[d][q];
  }
  for (int n = 0; n < e->of->where.count; n++) {
    const point_forces *p = e->of->by_points[n];
    if (p) show(w, p, p->observed, true, values);
  }
}

/* Of a linear law a point remembers nothing: asked for, it is looked at. J/m^3 stored, then
   outputs. */
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

/* --- set-up ----------------------------------------------------------------------------------- */

static void free_own(sweep *w) {
  cells_engine *e = own(w);
  for (int n = 0; n < e->of->where.count; n++) {
    point_law_free(e->parts[n].one);
    free(e->parts[n].observed);
    if (n > 0) sweep_free(e->parts[n].state);
  }
  free(e->parts);
  free(e->nodes);
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
  for (int d = 0; d < 2 && cells_some_linear(e->of) && !cells_all_linear(e->of); d++)
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
  e->nodes = must_calloc((size_t)mesh_node_count(&c->mesh) + 1, sizeof *e->nodes);
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

static const cells_part *part_of(const sweep *law) {
  return law->beside ? law->engine.own : &own(law)->parts[0];
}

void cells_give(const sweep *law, double *const *planes) {
  const cells_part *part = part_of(law);
  const cells *c = part->engine->of;
  double *nodes = part->engine->nodes;
  for (int k = 0; k < law->law->varying_count; k++) {
    for (int n = 0; n < mesh_node_count(&c->mesh); n++)
      nodes[n] = planes[k][cells_site(c, n)];
    point_forces_give(c->by_points[part->number], k, nodes);
  }
}

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
