#include "runtime/loads/mesh_rest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/continuum/static_solution.h"

/* A reaction of that part of the largest force is rounding; an energy of that part of what the
   displacements of an increment store is, too. */
static const double NO_REACTION = 1e-6, NO_ENERGY = 1e-12;

struct mesh_rest {
  const cells *c;
  loads *l;
  body *w;
  static_factors *factors;
  unsigned char *held, *factored; /* [2 nodes]; those of the factors */
  double *force[2], *u[2], *reaction[2];
  /* at the last increment: places, forces, reactions, weight */
  double *place[2], *pushed, *reacted, gravity[2];
  /* where points push */
  bool is_pushed;
  node_stencil stencil; /* of all laws; or */
  node_matrix matrix;
  load_clock clock;
  double *left[2]; /* [nodes] N: out of balance at the last increment */
  double given[2]; /* J: what is to be given at the places observed, in an increment */
  mesh_rest_account sum;
};

static void open_stiffness(mesh_rest *r) {
  const cells *c = r->c;
  r->is_pushed = !cells_all_linear(c);
  if (!r->is_pushed) return;
  if (c->mesh.lists) {
    node_matrix_open(&r->matrix, &c->mesh, &c->points, c->stiffness, c->where.of_cell);
    node_matrix_resist_hourglass(&r->matrix, &c->mesh, c->stiffness, c->where.of_cell);
  } else {
    node_stencil_open(&r->stencil, &c->mesh, &c->points, c->stiffness, c->where.of_cell);
    node_stencil_resist_hourglass(&r->stencil);
  }
}

static void close_stiffness(mesh_rest *r) {
  if (!r->is_pushed) return;
  if (r->c->mesh.lists)
    node_matrix_close(&r->matrix);
  else
    node_stencil_close(&r->stencil);
}

mesh_rest *mesh_rest_new(const cells *c, loads *l, body *w) {
  const size_t nodes = (size_t)mesh_node_count(&c->mesh);
  mesh_rest *r = must_calloc(1, sizeof *r);
  *r = (mesh_rest){.c = c, .l = l, .w = w};
  r->held = must_calloc(2 * nodes, 1);
  r->factored = must_calloc(2 * nodes, 1);
  for (int d = 0; d < 2; d++) {
    r->force[d] = must_calloc(nodes, sizeof(double));
    r->u[d] = must_calloc(nodes, sizeof(double));
    r->reaction[d] = must_calloc(nodes, sizeof(double));
    r->place[d] = must_calloc(nodes, sizeof(double));
    r->left[d] = must_calloc(nodes, sizeof(double));
  }
  open_stiffness(r);
  r->pushed = must_calloc((size_t)l->force_count + 1, sizeof(double));
  r->reacted = must_calloc((size_t)l->constraint_count + 1, sizeof(double));
  return r;
}

void mesh_rest_free(mesh_rest *r) {
  if (!r) return;
  static_factors_free(r->factors);
  for (int d = 0; d < 2; d++) {
    free(r->force[d]);
    free(r->u[d]);
    free(r->reaction[d]);
    free(r->place[d]);
    free(r->left[d]);
  }
  close_stiffness(r);
  free(r->held);
  free(r->factored);
  free(r->pushed);
  free(r->reacted);
  free(r);
}

/* --- an increment ----------------------------------------------------------------------------- */

static int node_of(const mesh_rest *r, int64_t site) {
  return cells_node(r->c, site);
}

static int node_count(const mesh_rest *r) {
  return mesh_node_count(&r->c->mesh);
}

/* What holds in the present increment. */
static void find_held(mesh_rest *r) {
  memset(r->held, 0, 2 * (size_t)node_count(r));
  for (long i = 0; i < r->l->constraint_count; i++) {
    const constraint *c = &r->l->constraints[i];
    if (load_steps_holds(r->l, r->w, c)) r->held[2 * node_of(r, c->site) + c->component] = 1;
  }
}

/* False where something is loose, which *found says. */
static bool has_factors(mesh_rest *r, static_result *found) {
  const size_t size = 2 * (size_t)node_count(r);
  if (r->factors && memcmp(r->held, r->factored, size) == 0) return true;
  static_factors_free(r->factors);
  const node_matrix *matrix = r->is_pushed ? &r->matrix : &r->c->matrix;
  const node_stencil *stencil = r->is_pushed ? &r->stencil : &r->c->stencil;
  r->factors = r->c->mesh.lists ? static_factors_of_matrix(matrix, r->held, found)
                                : static_factors_new(stencil, r->held, found);
  memcpy(r->factored, r->held, size);
  return r->factors != NULL;
}

/* As the last increment has left it. */
static void keep(mesh_rest *r) {
  for (int d = 0; d < 2; d++) {
    r->gravity[d] = r->w->gravity[d];
    for (int n = 0; n < node_count(r); n++)
      r->place[d][n] = r->w->displacement[d][cells_site(r->c, n)];
  }
  for (long i = 0; i < r->l->force_count; i++)
    r->pushed[i] = r->l->forces[i].now;
  for (long i = 0; i < r->l->constraint_count; i++)
    r->reacted[i] = r->l->constraints[i].reaction;
}

static void prescribe(mesh_rest *r, long step) {
  for (long i = 0; i < r->l->constraint_count; i++) {
    constraint *c = &r->l->constraints[i];
    if (!c->active) continue;
    c->held = c->anchor + load_steps_motion(r->l, r->w, c, step);
    r->u[c->component][node_of(r, c->site)] =
        c->held - (r->is_pushed ? r->w->displacement[c->component][c->site] : 0);
  }
}

/* Of the state observed last: what the points push by, and what is left out of balance by it. */
static void push_by_points(const mesh_rest *r, double *const force[2]) {
  for (int d = 0; d < 2 && r->is_pushed; d++)
    for (int n = 0; n < node_count(r); n++)
      force[d][n] += r->w->force[d][cells_site(r->c, n)];
}

static void find_left(mesh_rest *r) {
  for (int d = 0; d < 2 && r->is_pushed; d++)
    for (int n = 0; n < node_count(r); n++) {
      const long site = cells_site(r->c, n);
      const bool weighs = r->w->weight && !r->c->mesh.gone[n];
      r->left[d][n] = weighs ? r->w->gravity[d] * body_mass(r->w, d, site) : 0;
    }
  for (long i = 0; i < r->l->force_count && r->is_pushed; i++) {
    const applied *f = &r->l->forces[i];
    r->left[f->component][node_of(r, f->site)] += f->now;
  }
  push_by_points(r, r->left);
}

static void push(mesh_rest *r, long step) {
  load_steps_weigh(r->l, r->w, step);
  for (int d = 0; d < 2; d++)
    for (int n = 0; n < node_count(r); n++) {
      const long site = cells_site(r->c, n);
      const bool weighs = r->w->weight && !r->c->mesh.gone[n];
      r->force[d][n] = weighs ? r->w->gravity[d] * body_mass(r->w, d, site) : 0;
    }
  for (long i = 0; i < r->l->force_count; i++) {
    applied *f = &r->l->forces[i];
    f->now = f->share * load_steps_factor(r->l, r->w, f, step);
    r->force[f->component][node_of(r, f->site)] += f->now;
  }
}

bool mesh_rest_is_pushed(const mesh_rest *r) {
  return r->is_pushed;
}

void mesh_rest_begin(mesh_rest *r, load_clock clock) {
  keep(r);
  find_left(r);
  load_steps_increment(r->l, r->w, clock);
  r->clock = clock;
}

double mesh_rest_solve(mesh_rest *r) {
  const long end = (long)(r->clock.first + r->clock.ramp);
  static_result found = {.solved = false};
  find_held(r);
  if (!has_factors(r, &found)) return NAN; /* mesh_rest_check has told */
  prescribe(r, end);
  push(r, end);
  push_by_points(r, r->force);
  found = static_factors_solve(r->factors, (const double *const *)r->force, r->u, r->reaction);
  for (int d = 0; d < 2; d++)
    for (int n = 0; n < node_count(r); n++) {
      double *at = &r->w->displacement[d][cells_site(r->c, n)];
      *at = r->is_pushed ? *at + r->u[d][n] : r->u[d][n];
    }
  if (r->is_pushed) r->sum.turned = pl_fmax(r->sum.turned, found.energy);
  return found.residual;
}

void mesh_rest_see_given(mesh_rest *r, bool last) {
  const double now = body_sum(r->w).given_by_rest - r->w->given_before;
  r->given[last] = now;
  if (!last) return;
  const double mean = 0.5 * (r->given[0] + r->given[1]);
  if (fabs(mean) > NO_ENERGY * r->sum.turned) r->sum.given += mean;
  r->w->given_before = r->sum.given - now;
  r->w->rounding = NO_ENERGY * r->sum.turned;
}

mesh_rest_account *mesh_rest_sum(mesh_rest *r) {
  return &r->sum;
}

/* What was out of balance. */
static void let_go(const mesh_rest *r) {
  const body *w = r->w;
  double work = 0;
  for (int d = 0; d < 2 && r->is_pushed; d++)
    for (int n = 0; n < node_count(r); n++)
      if (!r->held[2 * n + d])
        work += 0.5 * r->left[d][n] * (w->displacement[d][cells_site(r->c, n)] - r->place[d][n]);
  if (fabs(work) > NO_ENERGY * r->sum.turned) w->row_mass[0] += work;
}

/* Loads go evenly from increment to increment, and so do places and reactions of a linear law: the
   mean force works over the whole way. */
void mesh_rest_work(mesh_rest *r) {
  const body *w = r->w;
  let_go(r);
  for (long i = 0; i < r->l->force_count; i++) {
    applied *f = &r->l->forces[i];
    const double way =
        w->displacement[f->component][f->site] - r->place[f->component][node_of(r, f->site)];
    f->sums.work += 0.5 * (r->pushed[i] + f->now) * way;
  }
  for (long i = 0; i < r->l->constraint_count; i++) {
    constraint *c = &r->l->constraints[i];
    const double way =
        w->displacement[c->component][c->site] - r->place[c->component][node_of(r, c->site)];
    c->sums.work += 0.5 * (r->reacted[i] + c->reaction) * way;
  }
  for (int d = 0; d < 2 && w->row_gravity; d++)
    for (int n = 0; n < node_count(r); n++) {
      const long site = cells_site(r->c, n);
      w->row_gravity[rows_row(w->lattice, site)] += 0.5 * (r->gravity[d] + w->gravity[d]) *
                                                    body_mass(w, d, site) *
                                                    (w->displacement[d][site] - r->place[d][n]);
    }
}

/* --- before a run ----------------------------------------------------------------------------- */

/* Quadrilaterals with motions that nothing resists. */
static bool has_single_points(const mesh *m) {
  for (int c = 0; c < mesh_cell_count(m); c++)
    if (m->cell[c] == CELL_ELEMENT && m->element_gauss[c] == 1 && !(m->hourglass[c] > 0) &&
        (!m->lists || m->lists->nodes[c] == 4))
      return true;
  return false;
}

static bool is_stiff(mesh_rest *r, const char *name, span where, diagnostics *d) {
  static_result found = {.solved = false};
  double at[2];
  find_held(r);
  if (has_factors(r, &found)) return true;
  mesh_place(&r->c->mesh, found.loose, at);
  diag_report(d, DIAG_BAD_VALUE, where,
              "the mesh `%s` can move freely: nothing holds its node at (%.6g, %.6g) mm along %s",
              name, 1e3 * at[0], 1e3 * at[1], found.loose_axis ? "y" : "x");
  diag_hint(d, has_single_points(&r->c->mesh)
                   ? "elements with one point of integration have motions without stiffness: give "
                     "`gauss = 2`, or `hourglass = 0.05`; and hold the mesh so that it can neither "
                     "slide nor turn"
                   : "hold it by a `&support` so that it can neither slide nor turn: both "
                     "directions of one node, and one of another");
  return false;
}

static const constraint *pin_with_reaction(const mesh_rest *r, double *reaction) {
  double most = 0;
  for (int n = 0; n < 2 * node_count(r); n++)
    most = pl_max(most, pl_max(fabs(r->force[n % 2][n / 2]), fabs(r->reaction[n % 2][n / 2])));
  for (long i = 0; i < r->l->constraint_count; i++) {
    const constraint *c = &r->l->constraints[i];
    const int node = node_of(r, c->site);
    *reaction = r->reaction[c->component][node];
    if (r->c->mesh.element_free[node] && fabs(*reaction) > NO_REACTION * most) return c;
  }
  return NULL;
}

/* The value of an element-free node is no displacement: it may stand for a motion of the whole, and
   must bear nothing. */
static bool pins_bear_nothing(const mesh_rest *r, span where, diagnostics *d) {
  double reaction, at[2];
  const constraint *c = pin_with_reaction(r, &reaction);
  if (!c) return true;
  mesh_place(&r->c->mesh, node_of(r, c->site), at);
  diag_report(d, DIAG_CONFLICT, where,
              "the support at (%.6g, %.6g) mm bears %.4g N along %s, but its node is element-free: "
              "what is held there is no displacement",
              1e3 * at[0], 1e3 * at[1], reaction, c->component ? "y" : "x");
  diag_hint(d, "make its node one of finite elements by a &zone; only a support that bears nothing "
               "may stand on an element-free node");
  return false;
}

static bool has_pins(const mesh_rest *r) {
  for (long i = 0; i < r->l->constraint_count; i++)
    if (r->c->mesh.element_free[node_of(r, r->l->constraints[i].site)]) return true;
  return false;
}

/* All loads and places as they are before the run. */
typedef struct kept_loads {
  constraint *constraints;
  applied *forces;
  load_clock clock;
} kept_loads;

static kept_loads keep_loads(const loads *l) {
  const size_t held = (size_t)l->constraint_count * sizeof(constraint),
               pushed = (size_t)l->force_count * sizeof(applied);
  kept_loads k = {must_alloc(held + 1), must_alloc(pushed + 1), l->clock};
  if (held) memcpy(k.constraints, l->constraints, held);
  if (pushed) memcpy(k.forces, l->forces, pushed);
  return k;
}

static void put_back(mesh_rest *r, kept_loads *k) {
  loads *l = r->l;
  if (l->constraint_count > 0)
    memcpy(l->constraints, k->constraints, (size_t)l->constraint_count * sizeof(constraint));
  if (l->force_count > 0) memcpy(l->forces, k->forces, (size_t)l->force_count * sizeof(applied));
  l->clock = k->clock;
  for (int d = 0; d < 2; d++) {
    r->w->gravity[d] = 0;
    for (int n = 0; n < node_count(r); n++)
      r->w->displacement[d][cells_site(r->c, n)] = r->u[d][n] = 0;
  }
  free(k->constraints);
  free(k->forces);
}

bool mesh_rest_check(mesh_rest *r, const char *name, span where, int increments, double interval,
                     diagnostics *d) {
  bool good = true;
  kept_loads kept = keep_loads(r->l);
  const bool pins = has_pins(r);
  for (int k = 0; k < increments && good; k++) {
    const load_clock clock = {
        .from = k * interval, .to = (k + 1) * interval, .first = k, .ramp = 1};
    r->l->clock = clock;
    good = is_stiff(r, name, where, d);
    if (!good || !pins) continue;
    mesh_rest_begin(r, clock);
    mesh_rest_solve(r);
    good = pins_bear_nothing(r, where, d);
  }
  put_back(r, &kept);
  return good;
}
