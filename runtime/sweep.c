#include "runtime/sweep.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "dsl/arena.h"
#include "runtime/family.h"
#include "runtime/pairwise.h"
#include "runtime/sweep_parts.h"

/* --- set-up ----------------------------------------------------------------------------------- */

double *sweep_doubles(sweep *w, long count) {
  w->bytes += (size_t)count * sizeof(double);
  return pool_doubles(w->memory, count);
}

/* Part of every row that holds sites, widened to whole vectors. */
static void find_spans(sweep *w) {
  const rows *g = w->lattice;
  w->begin = must_calloc((size_t)g->row_count, sizeof *w->begin);
  w->count = must_calloc((size_t)g->row_count, sizeof *w->count);
  for (int r = 0; r < g->row_count; r++) {
    const unsigned char *present = g->present + rows_start(g, r);
    long first = 0, end = g->pitch;
    while (first < end && !present[first])
      first++;
    while (end > first && !present[end - 1])
      end--;
    if (first == end) continue;
    w->begin[r] = first / PL_LANES * PL_LANES;
    w->count[r] = (end - w->begin[r] + PL_LANES - 1) / PL_LANES * PL_LANES;
  }
}

int sweep_planes(const sweep *w, int where) {
  if (w->law->kind != PL_STATE) return w->lattice->directions;
  return where == PL_ON_PARTICLE ? 1 : 2 * w->lattice->directions;
}

static void new_state(sweep *w, bool forces) {
  const rows *g = w->lattice;
  for (int d = 0; d < w->dof; d++) {
    w->displacement[d] = sweep_doubles(w, g->size);
    w->velocity[d] = sweep_doubles(w, g->size);
    if (forces) w->force[d] = sweep_doubles(w, g->size);
  }
  w->field = must_calloc((size_t)w->law->field_count + 1, sizeof *w->field);
  for (int f = 0; f < w->law->field_count; f++) {
    const long values = sweep_planes(w, w->law->fields[f].place) * g->size;
    w->field[f] = sweep_doubles(w, values);
    for (long k = 0; k < values; k++)
      w->field[f][k] = w->law->fields[f].initial;
  }
  double **sums[] = {&w->row_kinetic, &w->row_stored,   &w->row_mass,
                     &w->row_pending, &w->row_internal, &w->row_internal_pending};
  for (size_t k = 0; k < sizeof sums / sizeof *sums; k++)
    *sums[k] = sweep_doubles(w, g->row_count);
  w->row_stuck = must_calloc((size_t)g->row_count + 1, 1);
}

static void new_masses(sweep *w) {
  const rows *g = w->lattice;
  if (!g->site_mass) return;
  w->relative_mass = sweep_doubles(w, g->size);
  w->mobility = sweep_doubles(w, g->size);
  for (long q = 0; q < g->size; q++) {
    if (!g->present[q]) continue;
    w->relative_mass[q] = g->site_mass[q] / g->mass;
    w->mobility[q] = g->mass / g->site_mass[q];
  }
}

static void new_blocks(sweep *w, int threads) {
  const int n = w->lattice->row_count;
  w->block_count = threads < 1 ? 1 : threads < n ? threads : n;
  w->blocks = must_calloc((size_t)w->block_count, sizeof *w->blocks);
  for (int k = 0; k < w->block_count; k++)
    w->blocks[k] = (sweep_block){.first = (int)((long)n * k / w->block_count),
                                 .last = (int)((long)n * (k + 1) / w->block_count),
                                 .next = sweep_doubles(w, w->dof * w->lattice->pitch),
                                 .bad_site = -1};
}

sweep *sweep_new(const rows *lattice, const pl_law *law, const double *parameters, double time_step,
                 int threads, bool ledger, bool forces) {
  sweep *w = must_calloc(1, sizeof *w);
  const bool families = law->kind == PL_STATE;
  w->memory = pool_new();
  assert(law->dimensions == lattice->dimensions);
  w->lattice = lattice;
  w->law = law;
  w->time_step = time_step;
  w->decay = 1;
  w->ledger = ledger;
  w->forces = ledger || forces;
  w->dimensions = law->dimensions;
  w->dof = law->dof;
  for (int d = 0; d < w->dof; d++) {
    w->mass[d] = d < w->dimensions ? lattice->mass : lattice->inertia;
    w->limit[d] = (d < w->dimensions ? lattice->spacing : acos(-1)) / time_step;
  }
  find_spans(w);
  new_masses(w);
  new_state(w, ledger || forces || families);
  new_blocks(w, threads);
  w->engine = families ? family_engine(w, parameters) : pairwise_engine(w, parameters);
  return w;
}

void sweep_add_gravity(sweep *w) {
  w->weight = sweep_doubles(w, w->lattice->size);
  for (long q = 0; q < w->lattice->size; q++)
    w->weight[q] = w->lattice->present[q] ? 1 : 0;
  w->row_gravity = sweep_doubles(w, w->lattice->row_count);
}

void sweep_free(sweep *w) {
  if (!w) return;
  w->engine.free(w);
  free(w->field);
  free(w->row_stuck);
  free(w->begin);
  free(w->count);
  free(w->blocks);
  pool_free(w->memory);
  free(w);
}

/* --- floating point environment --------------------------------------------------------------- */

#if defined(__SSE2__)
enum { FLUSH_TO_ZERO = 0x8000, DENORMALS_ARE_ZERO = 0x0040 };

unsigned sweep_enter(void) {
  unsigned before = _mm_getcsr();
  _mm_setcsr(before | FLUSH_TO_ZERO | DENORMALS_ARE_ZERO);
  return before;
}

void sweep_leave(unsigned before) {
  _mm_setcsr(before);
}
#elif defined(__aarch64__)
unsigned sweep_enter(void) {
  uint64_t before;
  __asm__ volatile("mrs %0, fpcr" : "=r"(before));
  __asm__ volatile("msr fpcr, %0" : : "r"(before | (UINT64_C(1) << 24)));
  return (unsigned)before;
}

void sweep_leave(unsigned before) {
  __asm__ volatile("msr fpcr, %0" : : "r"((uint64_t)before));
}
#else
unsigned sweep_enter(void) {
  return 0;
}
void sweep_leave(unsigned before) {
  (void)before;
}
#endif

/* --- particles of a row ----------------------------------------------------------------------- */

/* Absent sites have no weight: they stay where they are. */
static int64_t add_push(long count, double push, double limit, const double *restrict weight,
                        double *restrict next) {
  int64_t bad = 0;
  INDEPENDENT
  for (long q = 0; q < count; q++) {
    const double after = next[q] + push * weight[q];
    next[q] = after;
    bad |= __builtin_fabs(after) < limit ? INT64_C(0) : INT64_C(1);
  }
  return bad;
}

int64_t sweep_push(const sweep *w, int row, int component, double *next) {
  if (!w->weight || component >= w->dimensions) return 0;
  return add_push(w->count[row], w->push[component], w->limit[component],
                  w->weight + sweep_start(w, row), next);
}

static void drift(long count, double time_step, const double *restrict next, double *restrict v,
                  double *restrict u) {
  INDEPENDENT
  for (long q = 0; q < count; q++) {
    v[q] = next[q];
    u[q] += time_step * next[q];
  }
}

/* Sum of a (a + b) or a b: eight lanes, then their sum. */
static double lane_sum(long count, const double *restrict a, const double *restrict b,
                       bool square) {
  double lane[PL_LANES] = {0};
  for (long q = 0; q < count; q += PL_LANES)
    for (int l = 0; l < PL_LANES; l++)
      lane[l] += a[q + l] * (square ? a[q + l] + b[q + l] : b[q + l]);
  double sum = 0;
  for (int l = 0; l < PL_LANES; l++)
    sum += lane[l];
  return sum;
}

/* The same, each term times a weight. */
static double weighed_sum(long count, const double *restrict weight, const double *restrict a,
                          const double *restrict b, bool square) {
  double lane[PL_LANES] = {0};
  for (long q = 0; q < count; q += PL_LANES)
    for (int l = 0; l < PL_LANES; l++)
      lane[l] += weight[q + l] * (a[q + l] * (square ? a[q + l] + b[q + l] : b[q + l]));
  double sum = 0;
  for (int l = 0; l < PL_LANES; l++)
    sum += lane[l];
  return sum;
}

/* Sum of m a (a + b) or m a b over the particles of a row, with m relative to their mean mass. */
static double mass_sum(const sweep *w, int row, const double *a, const double *b, bool square) {
  if (!w->relative_mass) return lane_sum(w->count[row], a, b, square);
  return weighed_sum(w->count[row], w->relative_mass + sweep_start(w, row), a, b, square);
}

double sweep_dot(long count, const double *a, const double *b) {
  return lane_sum(count, a, b, false);
}

double sweep_total(long count, const double *restrict a) {
  double lane[PL_LANES] = {0};
  for (long q = 0; q < count; q += PL_LANES)
    for (int l = 0; l < PL_LANES; l++)
      lane[l] += a[q + l];
  double sum = 0;
  for (int l = 0; l < PL_LANES; l++)
    sum += lane[l];
  return sum;
}

void sweep_note_bad(const sweep *w, sweep_block *b, int row) {
  w->row_stuck[row] = 1;
  if (b->bad_site >= 0 && b->bad_site < sweep_start(w, row)) return;
  for (long q = 0; q < w->count[row]; q++)
    for (int d = 0; d < w->dof; d++) {
      const double v = b->next[d * w->lattice->pitch + q];
      if (fabs(v) < w->limit[d]) continue;
      b->bad_site = sweep_start(w, row) + q;
      b->bad_component = d;
      b->bad_velocity = v;
      return;
    }
}

void sweep_drift(sweep *w, sweep_block *b, int row) {
  const long start = sweep_start(w, row), count = w->count[row];
  for (int d = 0; d < w->dof; d++) {
    double *next = b->next + d * w->lattice->pitch, *v = w->velocity[d] + start;
    if (w->decay < 1 && w->ledger)
      w->row_mass[row] += 0.5 * w->mass[d] * (1 - w->decay) * mass_sum(w, row, v, next, true);
    if (w->weight && d < w->dimensions)
      w->row_gravity[row] +=
          w->push_work[d] * (w->relative_mass ? sweep_dot(count, w->relative_mass + start, next)
                                              : sweep_total(count, next));
    drift(count, w->time_step, next, v, w->displacement[d] + start);
  }
}

int sweep_bad(const sweep *w) {
  for (int k = 0; k < w->block_count; k++)
    if (w->blocks[k].bad_site >= 0) return k;
  return -1;
}

void sweep_fields_set(sweep *w) {
  if (w->engine.fields_set) w->engine.fields_set(w);
}

void sweep_turn(sweep *w) {
  if (w->engine.turn) w->engine.turn(w);
}

bool sweep_step(sweep *w) {
  for (int stage = 0; stage < w->engine.step_stages; stage++)
    for (int b = 0; b < w->block_count; b++)
      w->engine.step(w, stage, b);
  if (sweep_bad(w) >= 0) return false;
  sweep_turn(w);
  return true;
}

void sweep_find_forces(sweep *w) {
#pragma omp parallel num_threads(w->block_count) if (w->block_count > 1)
  {
    const unsigned environment = sweep_enter();
    for (int stage = 0; stage < w->engine.force_stages; stage++) {
#pragma omp for schedule(static)
      for (int block = 0; block < w->block_count; block++)
        w->engine.forces(w, stage, block);
    }
    sweep_leave(environment);
  }
}

/* --- sampling --------------------------------------------------------------------------------- */

void sweep_observe_motion(sweep *w, const sweep_block *b, int row) {
  const long start = sweep_start(w, row);
  w->row_kinetic[row] = 0;
  w->row_pending[row] = 0;
  for (int d = 0; d < w->dof; d++) {
    const double *v = w->velocity[d] + start, *next = b->next + d * w->lattice->pitch;
    w->row_kinetic[row] += 0.5 * w->mass[d] * mass_sum(w, row, v, next, false);
    if (w->decay < 1)
      w->row_pending[row] += 0.5 * w->mass[d] * (1 - w->decay) * mass_sum(w, row, v, v, false);
  }
}

void sweep_observe(sweep *w) {
  for (int stage = 0; stage < w->engine.observe_stages; stage++)
    for (int b = 0; b < w->block_count; b++)
      w->engine.observe(w, stage, b);
}

void sweep_find_outputs(sweep *w) {
  if (w->engine.find_outputs) w->engine.find_outputs(w);
}

void sweep_output(sweep *w, int output, double *values) {
  w->engine.output(w, output, values);
}

double sweep_bond_value(const sweep *w, const double *values, const rows_bond *bond) {
  const rows *g = w->lattice;
  if (w->law->kind != PL_STATE) return values[bond->slot];
  const long back = bond->slot / g->size + g->directions;
  return 0.5 * (values[bond->slot] + values[back * g->size + g->particle_site[bond->j]]);
}

static double sum_of(const double *values, long count) {
  double sum = 0;
  for (long k = 0; k < count; k++)
    sum += values[k];
  return sum;
}

sweep_totals sweep_sum(const sweep *w) {
  const int n = w->lattice->row_count;
  sweep_totals t = {.kinetic = sum_of(w->row_kinetic, n),
                    .stored = sum_of(w->row_stored, n),
                    .internal = sum_of(w->row_internal, n) + sum_of(w->row_internal_pending, n),
                    .dissipated_mass = sum_of(w->row_mass, n),
                    .dissipated_pending = sum_of(w->row_pending, n)};
  if (w->weight) t.gravity = sum_of(w->row_gravity, n);
  if (w->dissipated_state) {
    t.dissipated_state = sum_of(w->dissipated_state, w->lattice->size);
    t.dissipated_rate = sum_of(w->dissipated_rate, w->lattice->size);
  }
  return t;
}
