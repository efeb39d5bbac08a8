#include "runtime/simulation/relaxation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/simulation/load_steps.h"

enum { LOOK_EVERY = 25 };                /* steps */
static const double forgotten = 0.01;    /* part of the largest force that still counts */
static const double while_loading = 0.1; /* part of the damping */

/* The longest side of the body, in steps of a long wave there and back: one covers at least half a
   spacing a step at the stability limit of the lattices at hand. */
static long ramp_of(const rows *g, double part) {
  double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
  double longest = 0;
  for (long p = 0; p < g->particle_count; p++) {
    double at[3];
    rows_place(g, g->particle_site[p], at);
    for (int c = 0; c < g->dimensions; c++) {
      lower[c] = pl_fmin(lower[c], at[c]);
      upper[c] = pl_fmax(upper[c], at[c]);
    }
  }
  for (int c = 0; c < g->dimensions; c++)
    longest = pl_fmax(longest, upper[c] - lower[c]);
  return (long)ceil(4 * (longest / g->spacing + 1) / part);
}

relaxation *relaxation_new(const deck *k, body *w, loads *l, double part) {
  relaxation *r = must_calloc(1, sizeof *r);
  const size_t size = (size_t)w->lattice->size;
  r->deck = &k->relaxation;
  r->body = w;
  r->loads = l;
  r->interval = k->simulation.end_time / k->relaxation.increments;
  r->ramp = ramp_of(w->lattice, part);
  for (int d = 0; d < w->dof; d++) {
    r->displacement[d] = must_calloc(size, sizeof(double));
    r->force[d] = must_calloc(size, sizeof(double));
  }
  r->total = must_calloc(size, sizeof *r->total);
  return r;
}

void relaxation_free(relaxation *r) {
  if (!r) return;
  for (int d = 0; d < r->body->dof; d++) {
    free(r->displacement[d]);
    free(r->force[d]);
  }
  free(r->total);
  free(r);
}

static bool is_loading(const relaxation *r, int64_t step) {
  return step - r->loads->clock.first < r->ramp;
}

static void damp(relaxation *r, int64_t step) {
  const double rate = (is_loading(r, step) ? while_loading : 1) * r->state.rate;
  r->body->decay = pl_exp(-rate * r->body->time_step);
}

load_clock relaxation_clock(const relaxation *r, int64_t first) {
  return (load_clock){.from = (double)r->state.done * r->interval,
                      .to = (double)(r->state.done + 1) * r->interval,
                      .first = first,
                      .ramp = r->ramp};
}

void relaxation_next(relaxation *r, int64_t step) {
  load_steps_increment(r->loads, r->body, relaxation_clock(r, step));
  damp(r, step);
}

void relaxation_begin(relaxation *r) {
  r->state.rate = 2 * M_PI / ((double)r->ramp * r->body->time_step);
  relaxation_next(r, 0);
}

bool relaxation_due(const relaxation *r, int64_t step) {
  return (step - r->loads->clock.first) % LOOK_EVERY == 0;
}

/* --- a look ----------------------------------------------------------------------------------- */

/* Since the last look: work of the forces, and its motion. */
static void adapt(relaxation *r) {
  const body *w = r->body;
  double work = 0, motion = 0;
  for (int d = 0; d < w->dof; d++)
    for (long p = 0; p < w->lattice->particle_count; p++) {
      const long q = w->lattice->particle_site[p];
      const double way = w->displacement[d][q] - r->displacement[d][q];
      work -= way * (w->force[d][q] - r->force[d][q]);
      motion += body_mass(w, d, q) * way * way;
      r->displacement[d][q] = w->displacement[d][q];
      r->force[d][q] = w->force[d][q];
    }
  if (work > 0 && motion > 0) r->state.rate = 2 * sqrt(work / motion);
}

static double square_of(double x) {
  return x * x;
}

typedef struct squares { /* N^2 */
  double free, held, applied;
} squares;

static void add_component(const relaxation *r, int d, squares *sum) {
  const body *w = r->body;
  const loads *l = r->loads;
  const double arm = d < w->dimensions ? 1 : w->lattice->spacing;
  const double gravity = d < w->dimensions ? w->gravity[d] : 0;
  for (long p = 0; p < w->lattice->particle_count; p++) {
    const long q = w->lattice->particle_site[p];
    const double weight = gravity * body_mass(w, d, q);
    r->total[q] = w->force[d][q] + weight;
    sum->applied += weight * weight;
  }
  for (long i = 0; i < l->force_count; i++) {
    if (l->forces[i].component != d) continue;
    r->total[l->forces[i].site] += l->forces[i].now;
    sum->applied += square_of(l->forces[i].now / arm);
  }
  for (long i = 0; i < l->constraint_count; i++) {
    const constraint *c = &l->constraints[i];
    if (c->component != d || !c->active) continue;
    sum->held += square_of(r->total[c->site] / arm);
    r->total[c->site] = 0;
  }
  for (long p = 0; p < w->lattice->particle_count; p++)
    sum->free += square_of(r->total[w->lattice->particle_site[p]] / arm);
}

static double unbalance_of(relaxation *r) {
  squares sum = {0, 0, 0};
  for (int d = 0; d < r->body->dof; d++)
    add_component(r, d, &sum);
  const double needed = sqrt(pl_fmax(sum.held, sum.applied));
  r->state.largest = pl_fmax(r->state.largest, needed);
  const double against = pl_fmax(needed, forgotten * r->state.largest);
  return sum.free == 0 ? 0 : sqrt(sum.free) / against;
}

bool relaxation_look(relaxation *r, int64_t step) {
  const int64_t steps = step - r->loads->clock.first;
  adapt(r);
  damp(r, step);
  r->state.unbalance = unbalance_of(r);
  if (steps < r->ramp) return false;
  const bool balanced = r->state.unbalance <= r->deck->tolerance;
  if (!balanced && steps < r->deck->most_steps) return false;
  r->state.done++;
  r->state.unbalanced += !balanced;
  r->state.steps = steps;
  return true;
}
