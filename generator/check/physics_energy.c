/* Work of the rate-free forces with states and damages held. */
#include "generator/check/physics_energy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/ir/derive.h"
#include "generator/ir/random_values.h"
#include "generator/lower/lower_inputs.h"

static const double ENERGY_TOLERANCE = 1e-9; /* of the work of the absolute forces */
static const double FORCE_TOLERANCE =
    1e-8; /* force and derivative of the energy are rounded differently */

/* The axes that do work without rate, and the forces on them: N s, M_i, M_j (J per unit of
   motion). */
enum { WAYS = FORCE_COUNT };
static const bench_axis way_axis[WAYS] = {AXIS_STRETCH, AXIS_THETA_I, AXIS_THETA_J};

typedef struct pull {
  double at[WAYS];
} pull;

static pull pull_at(const bench *b, double *const *states, const probe *p, int lane) {
  pull g;
  for (int k = 0; k < WAYS; k++)
    g.at[k] = p->out[k][lane];
  g.at[FORCE_N] *= bench_length(b, states, lane);
  return g;
}

static double size_of(pull g) {
  return fabs(g.at[0]) + fabs(g.at[1]) + fabs(g.at[2]);
}

/* --- the stress-free state -------------------------------------------------------------------- */

/* Solves matrix x = right for the ways that resist; the others stay. */
static pull solve(double matrix[WAYS][WAYS], pull right, int ways) {
  pull x = {{0}};
  double largest = 0;
  bool used[WAYS] = {false};
  int pivot_of[WAYS];
  for (int k = 0; k < ways; k++)
    for (int q = 0; q < ways; q++)
      largest = pl_fmax(largest, fabs(matrix[k][q]));
  for (int k = 0; k < ways; k++) {
    int pivot = -1;
    for (int row = 0; row < ways; row++)
      if (!used[row] && (pivot < 0 || fabs(matrix[row][k]) > fabs(matrix[pivot][k]))) pivot = row;
    pivot_of[k] = -1;
    if (!(fabs(matrix[pivot][k]) > 1e-12 * largest)) continue;
    used[pivot] = true;
    pivot_of[k] = pivot;
    for (int row = 0; row < ways; row++) {
      double share = row == pivot ? 0 : matrix[row][k] / matrix[pivot][k];
      for (int q = 0; q < ways && share != 0; q++)
        matrix[row][q] -= share * matrix[pivot][q];
      right.at[row] -= share * right.at[pivot];
    }
  }
  for (int k = 0; k < ways; k++)
    x.at[k] = pivot_of[k] < 0 ? 0 : right.at[pivot_of[k]] / matrix[pivot_of[k]][k];
  return x;
}

typedef struct search {
  double **states;
  motion at[BENCH_LANES];
  pull pull[BENCH_LANES], slope[WAYS][BENCH_LANES];
} search;

static void look(physics *p, search *z, int count, int way, double step, pull *out) {
  for (int lane = 0; lane < count; lane++) {
    motion m = z->at[lane];
    if (way >= 0) m.at[way_axis[way]] += step;
    bench_move(&p->b, z->states, lane, m);
  }
  probe_run(&p->b, &p->b.frozen, z->states, count);
  for (int lane = 0; lane < count; lane++)
    out[lane] = pull_at(&p->b, z->states, &p->b.frozen, lane);
}

static void improve(search *z, int lane, int ways, double step) {
  double matrix[WAYS][WAYS];
  for (int row = 0; row < ways; row++)
    for (int k = 0; k < ways; k++)
      matrix[row][k] = (z->slope[k][lane].at[row] - z->pull[lane].at[row]) / step;
  pull change = solve(matrix, z->pull[lane], ways);
  for (int k = 0; k < ways; k++)
    z->at[lane].at[way_axis[k]] -= pl_fmin(pl_fmax(change.at[k], -1), 1);
}

/* Newton's method from rest, all states at once. `there`: the pull at the states themselves. */
static void find_stress_free(physics *p, search *z, int count, const pull *there,
                             const motion *target, work_done *out) {
  enum { ROUNDS = 8 };
  const double step = 1e-7;
  int ways = p->b.micropolar ? WAYS : 1;
  double rest[BENCH_LANES];
  for (int round = 0; round <= ROUNDS; round++) {
    look(p, z, count, -1, 0, z->pull);
    bool all = true;
    for (int lane = 0; lane < count; lane++) {
      double left = size_of(z->pull[lane]);
      if (round == 0) {
        rest[lane] = left;
        /* A state close to its stress-free point has an energy that is all rounding; the work from
           rest is what it is small against. */
        for (int k = 0; k < ways; k++)
          out[lane].size += fabs(z->pull[lane].at[k] * target[lane].at[way_axis[k]]);
      }
      out[lane].known = left <= 1e-10 * (size_of(there[lane]) + rest[lane]);
      all = all && out[lane].known;
    }
    if (all || round == ROUNDS) return;
    for (int k = 0; k < ways; k++)
      look(p, z, count, k, step, z->slope[k]);
    for (int lane = 0; lane < count; lane++)
      if (!out[lane].known) improve(z, lane, ways, step);
  }
}

/* --- work ------------------------------------------------------------------------------------- */

static const double gauss_at[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                   0.9602898564975363};
static const double gauss_weight[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                       0.1012285362903763};

static void add_work(physics *p, search *z, int count, const motion *target, double way,
                     double weight, work_done *out) {
  for (int lane = 0; lane < count; lane++) {
    motion m = z->at[lane];
    for (int k = 0; k < WAYS; k++)
      m.at[way_axis[k]] += way * (target[lane].at[way_axis[k]] - z->at[lane].at[way_axis[k]]);
    bench_move(&p->b, z->states, lane, m);
  }
  probe_run(&p->b, &p->b.frozen, z->states, count);
  for (int lane = 0; lane < count; lane++) {
    pull g = pull_at(&p->b, z->states, &p->b.frozen, lane);
    for (int k = 0; k < WAYS; k++) {
      double part = weight * g.at[k] * (target[lane].at[way_axis[k]] - z->at[lane].at[way_axis[k]]);
      out[lane].work += part;
      out[lane].size += fabs(part);
    }
  }
}

static void copy_states(const bench *b, double *const *from, double *const *to, int count) {
  for (int k = 0; k < b->width; k++)
    memcpy(to[k], from[k], (size_t)count * sizeof(double));
}

void physics_work(physics *p, double *const *states, int count, int panels, work_done *out) {
  search *z = must_calloc(1, sizeof *z);
  z->states = bench_states(&p->b);
  copy_states(&p->b, states, z->states, count);
  motion target[BENCH_LANES];
  pull there[BENCH_LANES];
  for (int lane = 0; lane < count; lane++) {
    out[lane] = (work_done){0};
    target[lane] = bench_motion(&p->b, states, lane);
    target[lane].at[AXIS_RATE] = 0;
    z->at[lane] = target[lane];
  }
  look(p, z, count, -1, 0, there);
  memset(z->at, 0, sizeof z->at);
  find_stress_free(p, z, count, there, target, out);
  for (int panel = 0; panel < panels; panel++)
    for (int k = 0; k < 8; k++) {
      double at = k < 4 ? -gauss_at[k] : gauss_at[k - 4];
      add_work(p, z, count, target, (panel + 0.5 * (1 + at)) / panels,
               0.5 * gauss_weight[k % 4] / panels, out);
    }
  bench_states_free(&p->b, z->states);
  free(z);
}

/* --- stored energy ---------------------------------------------------------------------------- */

static int pool_batch(physics *p, int first, double *const *states) {
  int count = 0;
  for (int k = first; k < p->pool_count && count < BENCH_LANES; k++)
    bench_put(&p->b, states, count++, p->pool + (size_t)k * (size_t)p->b.width);
  return count;
}

/* True when finer quadrature agrees that the work to lane 0 is negative. */
static bool stays_negative(physics *p, double *const *states, work_done *w) {
  double before = w->work;
  for (int panels = 8; panels <= 256; panels *= 2) {
    physics_work(p, states, 1, panels, w);
    if (!w->known || w->work >= -ENERGY_TOLERANCE * w->size) return false;
    if (fabs(w->work - before) <= 0.1 * fabs(w->work)) return true;
    before = w->work;
  }
  return false;
}

/* The force that takes the most out at the state of lane 0, beside that of lane 1 when there are
 * two. */
static int force_at_fault(physics *p, double *const *states, int count) {
  motion m = bench_motion(&p->b, states, 0);
  probe_run(&p->b, &p->b.frozen, states, count);
  pull g = pull_at(&p->b, states, &p->b.frozen, 0), other = {{0}};
  if (count > 1) other = pull_at(&p->b, states, &p->b.frozen, 1);
  int worst = FORCE_N;
  double least = 0;
  for (int k = 0; k < WAYS; k++) {
    double part = (g.at[k] - other.at[k]) * m.at[way_axis[k]];
    worst = part < least ? k : worst;
    least = pl_fmin(least, part);
  }
  return worst;
}

void physics_check_stored_energy(physics *p) {
  bench *b = &p->b;
  double **states = bench_states(b), *column = must_alloc((size_t)b->width * sizeof *column);
  for (int first = 0;
       first < p->pool_count && !p->failed[DIAG_STORED_ENERGY] && !(first && bench_tired(b));
       first += BENCH_LANES) {
    work_done w[BENCH_LANES];
    int count = pool_batch(p, first, states);
    physics_work(p, states, count, 1, w);
    for (int lane = 0; lane < count && !p->failed[DIAG_STORED_ENERGY]; lane++) {
      if (!w[lane].known || !(w[lane].work < -ENERGY_TOLERANCE * w[lane].size)) continue;
      bench_get(b, states, lane, column);
      double **alone = bench_states(b);
      bench_put(b, alone, 0, column);
      if (stays_negative(p, alone, &w[lane]))
        physics_say(p, DIAG_STORED_ENERGY, physics_fault(p, force_at_fault(p, alone, 1), column),
                    column,
                    "the bond stores a negative energy, %.4g J: it would give work without having "
                    "taken any",
                    w[lane].work);
      bench_states_free(b, alone);
    }
  }
  bench_states_free(b, states);
  free(column);
}

/* --- damage force ----------------------------------------------------------------------------- */

/* What a plain state stores nobody can tell (a slider beside a spring): they are as in a virgin
   bond, so that the energy is the work from rest. */
static void forget_states(const bench *b, double *const *states, int count) {
  for (int k = 0; k < b->field_count; k++)
    for (int lane = 0; lane < count && b->law->fields.items[k]->kind == SYMBOL_STATE; lane++)
      bench_field(b, states, k)[lane] = b->law->fields.items[k]->initial;
}

static void check_rising(physics *p, int field, double *const *states, int count) {
  enum { LEVELS = 6 };
  static const double level[LEVELS] = {0, 0.25, 0.5, 0.75, 0.95, 1};
  bench *b = &p->b;
  const symbol *s = b->law->fields.items[field];
  work_done w[2][BENCH_LANES];
  forget_states(b, states, count);
  for (int k = 0; k < LEVELS; k++) {
    for (int lane = 0; lane < count; lane++)
      bench_field(b, states, field)[lane] = level[k];
    physics_work(p, states, count, 1, w[k % 2]);
    for (int lane = 0; lane < count && k > 0 && !p->failed[DIAG_DAMAGE_FORCE]; lane++) {
      work_done less = w[(k + 1) % 2][lane], more = w[k % 2][lane];
      if (!less.known || !more.known ||
          !(more.work - less.work > 1e-7 * pl_fmax(less.size, more.size)))
        continue;
      double *column = must_alloc((size_t)b->width * sizeof *column);
      bench_get(b, states, lane, column);
      double **pair = bench_states(b);
      bench_put(b, pair, 0, column);
      bench_put(b, pair, 1, column);
      bench_field(b, pair, field)[0] = level[k - 1];
      physics_say(p, DIAG_DAMAGE_FORCE, physics_fault(p, force_at_fault(p, pair, 2), column),
                  column,
                  "the stored energy rises from %.4g to %.4g J when damage `%s` grows from %g to "
                  "%g: damage would heal "
                  "the bond",
                  less.work, more.work, s->name, level[k - 1], level[k]);
      diag_hint(p->said,
                "a damage of 0 leaves the bond whole, one of 1 leaves nothing: forces carry a "
                "factor such as (1 - %s)",
                s->name);
      bench_states_free(b, pair);
      free(column);
    }
  }
}

void physics_check_damage_force(physics *p) {
  bench *b = &p->b;
  double **states = bench_states(b);
  for (int k = 0; k < b->field_count; k++)
    for (int first = 0;
         first < p->pool_count && first < 2 * BENCH_LANES && !(first && bench_tired(b));
         first += BENCH_LANES)
      if (b->law->fields.items[k]->kind == SYMBOL_DAMAGE)
        check_rising(p, k, states, pool_batch(p, first, states));
  bench_states_free(b, states);
}

/* --- flow ------------------------------------------------------------------------------------- */

/* What the law's own energy says of lanes 0 and 1. */
static bool energy_gains(bench *b, double *const *pair, double *gain, double *stored) {
  probe W = probe_new(b, &b->law_frozen.W, 1);
  probe_run(b, &W, pair, 2);
  *stored = W.out[0][0];
  *gain = W.out[0][1] - W.out[0][0];
  probe_free(&W);
  return *gain > 1e-7 * fabs(*stored);
}

bool physics_flow_gains(physics *p, double *const *states, int lane, double *gain, double *stored) {
  bench *b = &p->b;
  /* Without an energy nobody can tell what a state stores: a back-force of hardening, say. Then
     only the cycles of the dissipation check judge. */
  if (b->law_frozen.W == IR_NONE) return false;
  double **pair = bench_states(b), *column = must_alloc((size_t)b->width * sizeof *column);
  bench_get(b, states, lane, column);
  bench_put(b, pair, 0, column);
  bench_put(b, pair, 1, column);
  probe_run(b, &b->step, pair, 1);
  for (int k = 0; k < b->field_count; k++)
    if (b->law->fields.items[k]->kind == SYMBOL_STATE)
      bench_field(b, pair, k)[1] = b->step.out[FORCE_COUNT + k][0];
  bool gains = energy_gains(b, pair, gain, stored);
  bench_states_free(b, pair);
  free(column);
  return gains;
}

/* --- energy and force ------------------------------------------------------------------------- */

/* The forces that the law's energy implies at fixed fields. */
static void implied_forces(bench *b, ir_node *nodes) {
  static const builtin_quantity by[WAYS] = {QUANTITY_STRETCH, QUANTITY_THETA_I, QUANTITY_THETA_J};
  ir *g = b->graph;
  ir_node W = b->law_frozen.W;
  for (int k = 0; k < WAYS; k++)
    nodes[k] = ir_derivative(g, W, lower_quantity(g, by[k]));
  const ir_node by_length = ir_derivative(g, W, lower_quantity(g, QUANTITY_LENGTH));
  nodes[FORCE_N] = ir_add(g, ir_div(g, nodes[FORCE_N], lower_quantity(g, QUANTITY_S)), by_length);
}

void physics_check_energy_and_force(physics *p) {
  static const law_result given[WAYS] = {RESULT_N, RESULT_M_I, RESULT_M_J};
  bench *b = &p->b;
  if (b->law_frozen.W == IR_NONE) return;
  ir_node nodes[2 * WAYS] = {b->law_frozen.N, b->law_frozen.M_i[0], b->law_frozen.M_j[0]};
  implied_forces(b, nodes + WAYS);
  probe both = probe_new(b, nodes, 2 * WAYS);
  double **states = bench_states(b), *column = must_alloc((size_t)b->width * sizeof *column);
  for (int first = 0; first < p->pool_count && !(first && bench_tired(b)); first += BENCH_LANES) {
    int count = pool_batch(p, first, states);
    memset(bench_quantity(b, states, QUANTITY_STRETCH_RATE), 0, (size_t)count * sizeof(double));
    probe_run(b, &both, states, count);
    for (int lane = 0; lane < count; lane++)
      for (int k = 0; k < WAYS; k++) {
        bool says = b->law->results[given[k]] || (k != FORCE_N && b->law->results[RESULT_V]);
        double size =
            bench_size(b, states, &both, lane) * (k == FORCE_N ? 1 : bench_length(b, states, lane));
        double force = both.out[k][lane], implied = both.out[WAYS + k][lane];
        if (!says || p->failed[DIAG_ENERGY_FORCE] ||
            !(fabs(force - implied) > FORCE_TOLERANCE * pl_fmax(size, fabs(implied))))
          continue;
        bench_get(b, states, lane, column);
        physics_say(p, DIAG_ENERGY_FORCE, physics_fault(p, k, column), column,
                    "`%s` is %.6g %s, but the derivative of the law's energy is %.6g %s",
                    physics_force_names[k], force, physics_force_units[k], implied,
                    physics_force_units[k]);
        diag_hint(p->said,
                  fabs(implied) > 0
                      ? "give the energy alone; the forces follow from it"
                      : "at states that stay this energy does not change with the "
                        "deformation: a force that is a state of its own has none; leave "
                        "`energy` out, or let the state be a deformation, `k*(stretch - v)`");
      }
  }
  probe_free(&both);
  bench_states_free(b, states);
  free(column);
}
