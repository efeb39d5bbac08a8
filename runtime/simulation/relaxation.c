#include "runtime/simulation/relaxation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/loads/load_steps.h"

enum { LOOK_EVERY = 25 };                /* steps */
static const double forgotten = 0.01;    /* part of the largest force that still counts */
static const double while_loading = 0.1; /* part of the damping */
static const double slight = 1e-5;       /* loads beside the forces between particles */
static const double rounding = 1e-15;    /* strain */

typedef struct extent { /* m */
  double lower[3], upper[3], spacing;
} extent;

static const extent nowhere = {
    {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, INFINITY};

static void reach_out(extent *e, const rows *g) {
  for (long p = 0; p < g->particle_count; p++) {
    double at[3];
    rows_place(g, g->particle_site[p], at);
    for (int c = 0; c < g->dimensions; c++) {
      e->lower[c] = pl_fmin(e->lower[c], at[c]);
      e->upper[c] = pl_fmax(e->upper[c], at[c]);
    }
  }
  e->spacing = pl_fmin(e->spacing, g->spacing);
}

/* The longest side of the body, in steps of a long wave there and back: one covers at least half a
   spacing a step at the stability limit of the lattices at hand. */
static long ramp_of(const extent *e, double part) {
  double longest = 0;
  for (int c = 0; c < 3; c++)
    longest = pl_fmax(longest, e->upper[c] - e->lower[c]);
  return (long)ceil(4 * (longest / e->spacing + 1) / part);
}

/* Bodies that are tied to each other are one. */
static long longest_ramp(const run_body *bodies, int count, double part) {
  extent tied = nowhere;
  long ramp = 0;
  for (int b = 0; b < count; b++) {
    extent own = nowhere, *e = bodies[b].tied ? &tied : &own;
    reach_out(e, bodies[b].lattice_rows);
    const long here = ramp_of(e, part);
    ramp = here > ramp ? here : ramp;
  }
  return ramp;
}

relaxation *relaxation_new(const deck *k, const run_body *bodies, int count, double part) {
  relaxation *r = must_calloc(1, sizeof *r);
  size_t largest = 0;
  r->deck = &k->relaxation;
  r->goes_on = k->start.result != NULL;
  r->bodies = bodies;
  r->body_count = count;
  r->interval = k->simulation.end_time / k->relaxation.increments;
  r->state.next_look = 1;
  r->state.part = 1;
  r->ramp = r->deck->solved ? 1 : longest_ramp(bodies, count, part);
  r->looked_at = must_calloc((size_t)count, sizeof *r->looked_at);
  for (int b = 0; b < count; b++) {
    const size_t size = (size_t)bodies[b].lattice_rows->size;
    largest = size > largest ? size : largest;
    for (int d = 0; d < bodies[b].body->dof; d++) {
      r->looked_at[b].displacement[d] = must_calloc(size, sizeof(double));
      r->looked_at[b].force[d] = must_calloc(size, sizeof(double));
    }
  }
  r->total = must_calloc(largest, sizeof *r->total);
  return r;
}

void relaxation_free(relaxation *r) {
  if (!r) return;
  for (int b = 0; b < r->body_count; b++)
    for (int d = 0; d < r->bodies[b].body->dof; d++) {
      free(r->looked_at[b].displacement[d]);
      free(r->looked_at[b].force[d]);
    }
  free(r->looked_at);
  free(r->total);
  free(r);
}

/* The clocks of all loads are the same. */
static int64_t first_step(const relaxation *r) {
  return r->bodies[0].loads->clock.first;
}

static bool is_loading(const relaxation *r, int64_t step) {
  return step - first_step(r) < r->ramp;
}

static void damp(relaxation *r, int64_t step) {
  const double part = is_loading(r, step) ? while_loading : 1;
  for (int b = 0; b < r->body_count; b++)
    r->bodies[b].body->decay =
        pl_exp(-(part * r->looked_at[b].state.rate) * r->bodies[b].body->time_step);
}

load_clock relaxation_clock(const relaxation *r, int64_t first) {
  return (load_clock){.from = (double)r->state.done * r->interval,
                      .to = (double)(r->state.done + 1) * r->interval,
                      .first = first,
                      .ramp = r->ramp,
                      .goes_on = r->goes_on};
}

void relaxation_next(relaxation *r, int64_t step) {
  for (int b = 0; b < r->body_count; b++)
    load_steps_increment(r->bodies[b].loads, r->bodies[b].body, relaxation_clock(r, step));
  damp(r, step);
}

void relaxation_begin(relaxation *r) {
  for (int b = 0; b < r->body_count; b++)
    r->looked_at[b].state.rate = 2 * M_PI / ((double)r->ramp * r->bodies[b].body->time_step);
  relaxation_next(r, 0);
}

void relaxation_solved(relaxation *r, double unbalance) {
  r->state.done++;
  r->state.steps = 1;
  r->state.unbalance = unbalance;
}

bool relaxation_due(const relaxation *r, int64_t step) {
  return (step - first_step(r)) % LOOK_EVERY == 0;
}

bool relaxation_stiffness_due(const relaxation *r) {
  return !r->deck->solved && r->state.done > 0 && r->state.done >= r->state.next_look &&
         r->state.done < r->deck->increments;
}

double relaxation_stiffness(relaxation *r, double part) {
  const double growing = 0.995, before = r->state.part;
  const bool grows = part < growing * before;
  r->state.next_look = grows ? r->state.done + 1 : 2 * r->state.done;
  r->state.part = part;
  return grows ? part * part / before : part;
}

/* --- a look ----------------------------------------------------------------------------------- */

/* Of bonds, links and contacts, which give way as the body moves. */
static void take_forces(const run_body *of, int d, double *force) {
  const loads *l = of->loads;
  for (long q = 0; q < of->lattice_rows->size; q++)
    force[q] = of->body->force[d][q] + body_outer(of->body, d, q);
  for (long i = 0; i < l->force_count; i++)
    if (l->forces[i].link && l->forces[i].component == d)
      force[l->forces[i].site] += loads_acting(&l->forces[i]);
}

/* Since the last look: work of the forces, and its motion. */
static void add_motion(const run_body *of, relaxed_body *last, double *force, double *work,
                       double *motion) {
  const body *w = of->body;
  for (int d = 0; d < w->dof; d++) {
    take_forces(of, d, force);
    for (long p = 0; p < w->lattice->particle_count; p++) {
      const long q = w->lattice->particle_site[p];
      if (!(body_mass(w, d, q) > 0)) continue; /* a tie moves it */
      const double way = w->displacement[d][q] - last->displacement[d][q];
      *work -= way * (force[q] - last->force[d][q]);
      *motion += body_mass(w, d, q) * way * way;
      last->displacement[d][q] = w->displacement[d][q];
      last->force[d][q] = force[q];
    }
  }
}

/* Bodies that are tied together swing together. */
static void adapt(relaxation *r) {
  double work_tied = 0, motion_tied = 0;
  for (int b = 0; b < r->body_count; b++) {
    const run_body *of = &r->bodies[b];
    double work = 0, motion = 0;
    if (run_body_is_link(of)) continue;
    add_motion(of, &r->looked_at[b], r->total, &work, &motion);
    if (!of->tied && work > 0 && motion > 0) r->looked_at[b].state.rate = 2 * sqrt(work / motion);
    work_tied += of->tied ? work : 0;
    motion_tied += of->tied ? motion : 0;
  }
  for (int b = 0; b < r->body_count; b++)
    if (r->bodies[b].tied && work_tied > 0 && motion_tied > 0)
      r->looked_at[b].state.rate = 2 * sqrt(work_tied / motion_tied);
}

static double square_of(double x) {
  return x * x;
}

typedef struct squares { /* N^2 */
  double free, held, applied;
} squares;

/* In space, of the moment on a particle about axis d what nothing holds, from constraint i of its
   rotations on; returns how many there are (load_steps_release). */
static int free_moment(const run_body *of, long i, int d, double *left) {
  const body *w = of->body;
  const loads *l = of->loads;
  const int64_t site = l->constraints[i].site;
  double moment[3] = {0, 0, 0};
  if (w->dof < 6 || l->constraints[i].component < w->dimensions) return 0;
  for (int k = 0; k < 3; k++)
    moment[k] = w->force[w->dimensions + k][site];
  for (long n = load_steps_first_force(l, site); n < l->force_count && l->forces[n].site == site;
       n++)
    if (l->forces[n].component >= w->dimensions)
      moment[l->forces[n].component - w->dimensions] += loads_acting(&l->forces[n]);
  const int count = load_steps_release(l, w, i, moment);
  if (d >= w->dimensions) *left = moment[d - w->dimensions];
  return count;
}

static void add_component(const relaxation *r, const run_body *of, int d, squares *sum) {
  const body *w = of->body;
  const loads *l = of->loads;
  const double arm = d < w->dimensions ? 1 : w->lattice->spacing;
  const double gravity = d < w->dimensions ? w->gravity[d] : 0;
  for (long p = 0; p < w->lattice->particle_count; p++) {
    const long q = w->lattice->particle_site[p];
    const double load = gravity * body_mass(w, d, q) + body_outer(w, d, q);
    r->total[q] = w->force[d][q] + load;
    sum->applied += load * load;
    if (body_mass(w, d, q) > 0) continue;
    sum->held += square_of(r->total[q] / arm); /* by a tie */
    r->total[q] = 0;
  }
  for (long i = 0; i < l->force_count; i++) {
    if (l->forces[i].component != d) continue;
    r->total[l->forces[i].site] += loads_acting(&l->forces[i]);
    sum->applied += square_of(loads_acting(&l->forces[i]) / arm);
  }
  for (long i = 0; i < l->constraint_count; i++) {
    const constraint *c = &l->constraints[i];
    double *here = &r->total[c->site], left = *here;
    const int turning = free_moment(of, i, d, &left);
    if (!turning && c->component == d && c->active) left = 0;
    sum->held += square_of((*here - left) / arm);
    *here = left;
    i += turning ? turning - 1 : 0;
  }
  for (long p = 0; p < w->lattice->particle_count; p++)
    sum->free += square_of(r->total[w->lattice->particle_site[p]] / arm);
}

/* N/m: of a bond of a chain with the largest frequency of the body. */
static double bond_stiffness(const run_body *of) {
  return 0.25 * of->body->mass[0] * square_of(of->limit.omega_max);
}

/* N: the root of the sum of squares of forces between particles. Bonds of stiffness k under forces
   N store the sum of N^2/(2 k). 0 where it is not known what they store. */
static double inner_force(const run_body *of, double stiffness) {
  const double stored = body_sum(of->body).stored;
  return stored > 0 ? sqrt(2 * stored * stiffness) : 0;
}

/* N: what rounding leaves of them. */
static double rounding_force(const run_body *of, double stiffness) {
  const double count = (double)of->body->dof * (double)of->lattice_rows->particle_count;
  return rounding * stiffness * of->lattice_rows->spacing * sqrt(count);
}

static double unbalance_of(const relaxation *r, int number) {
  squares sum = {0, 0, 0};
  const run_body *of = &r->bodies[number];
  relaxed_state *state = &r->looked_at[number].state;
  const double stiffness = bond_stiffness(of);
  for (int d = 0; d < of->body->dof; d++)
    add_component(r, of, d, &sum);
  const double needed = sqrt(pl_fmax(sum.held, sum.applied));
  state->largest = pl_fmax(state->largest, needed);
  state->inner = pl_fmax(state->inner, inner_force(of, stiffness));
  const double outer = pl_fmax(needed, forgotten * state->largest), within = slight * state->inner,
               left = sqrt(sum.free);
  state->within = within > outer;
  /* nothing loads the body but what rounding leaves, and no more is left */
  if (pl_fmax(left, outer) <= rounding_force(of, stiffness)) return 0;
  return left == 0 ? 0 : left / pl_fmax(outer, within);
}

/* NaN is no balance. The forces of a link are looked at where they act. */
static double largest_unbalance(const relaxation *r) {
  double most = 0;
  for (int b = 0; b < r->body_count; b++) {
    if (run_body_is_link(&r->bodies[b])) continue;
    const double here = unbalance_of(r, b);
    if (!(here <= most)) most = here;
  }
  return most;
}

/* No body has loads or reactions to speak of. */
static bool is_within(const relaxation *r) {
  for (int b = 0; b < r->body_count; b++)
    if (!run_body_is_link(&r->bodies[b]) && !r->looked_at[b].state.within) return false;
  return true;
}

bool relaxation_look(relaxation *r, int64_t step) {
  const int64_t steps = step - first_step(r);
  adapt(r);
  damp(r, step);
  r->state.unbalance = largest_unbalance(r);
  if (steps < r->ramp) return false;
  const bool balanced = r->state.unbalance <= r->deck->tolerance;
  if (!balanced && steps < r->deck->most_steps) return false;
  r->state.done++;
  r->state.unbalanced += !balanced;
  r->state.within += is_within(r);
  r->state.steps = steps;
  return true;
}
