#include "runtime/interaction/sweep.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "dsl/base/arena.h"
#include "runtime/interaction/family.h"
#include "runtime/interaction/pairwise.h"
#include "runtime/interaction/sweep_parts.h"

/* --- set-up ----------------------------------------------------------------------------------- */

double *sweep_doubles(sweep *w, long count) {
  w->bytes += (size_t)count * sizeof(double);
  return pool_doubles(w->memory, count);
}

void *sweep_apart(sweep *w, size_t bytes) {
  const long gap = SWEEP_APART / (long)sizeof(double);
  return sweep_doubles(w, (long)((bytes + sizeof(double) - 1) / sizeof(double)) + 2 * gap) + gap;
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

static void new_state(sweep *w) {
  const rows *g = w->lattice;
  for (int d = 0; d < w->dof; d++) {
    w->displacement[d] = sweep_doubles(w, g->size);
    w->velocity[d] = sweep_doubles(w, g->size);
    w->force[d] = sweep_doubles(w, g->size);
  }
  w->field = must_calloc((size_t)w->law->field_count + 1, sizeof *w->field);
  w->new_field = must_calloc((size_t)w->law->field_count + 1, sizeof *w->new_field);
  for (int f = 0; f < w->law->field_count; f++) {
    const long values = sweep_planes(w, w->law->fields[f].place) * g->size;
    w->field[f] = sweep_doubles(w, values);
    w->new_field[f] = sweep_doubles(w, values);
    for (long k = 0; k < values; k++)
      w->field[f][k] = w->new_field[f][k] = w->law->fields[f].initial;
  }
  w->row_mass = sweep_doubles(w, g->row_count);
  w->row_internal = sweep_doubles(w, g->row_count);
  w->observed = must_calloc((size_t)g->row_count, sizeof *w->observed);
  w->row_stuck = must_calloc((size_t)g->row_count, sizeof *w->row_stuck);
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

static long doubles_below(const sweep *w, int row) {
  long sum = 0;
  for (int r = 0; r < row; r++)
    sum += w->count[r];
  return sum;
}

/* Where a block that begins with row `first` ends. Laws of families share out rows, as blocks read some of those of their
   neighbours; laws of bonds share out what stands on the rows, to the nearest row. */
static int end_of_block(const sweep *w, int block, int first) {
  const int n = w->lattice->row_count, most = n - (w->block_count - 1 - block);
  if (w->law->kind == PL_STATE) return (int)((long)n * (block + 1) / w->block_count);
  const long wanted = doubles_below(w, n) * (block + 1) / w->block_count;
  long below = doubles_below(w, first + 1);
  int end = first + 1;
  while (end < most && below + w->count[end] / 2 <= wanted)
    below += w->count[end++];
  return end;
}

static void new_blocks(sweep *w, int threads) {
  const int n = w->lattice->row_count;
  w->block_count = threads < 1 ? 1 : threads < n ? threads : n;
  w->blocks = must_calloc((size_t)w->block_count, sizeof *w->blocks);
  for (int k = 0, first = 0; k < w->block_count; first = w->blocks[k++].last)
    w->blocks[k] = (sweep_block){.first = first,
                                 .last = end_of_block(w, k, first),
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
    w->limit[d] = (d < w->dimensions ? lattice->spacing : M_PI) / time_step;
  }
  find_spans(w);
  new_masses(w);
  new_state(w);
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
  free(w->new_field);
  free(w->row_stuck);
  free(w->observed);
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

int64_t sweep_push(const sweep *w, row_part at, int component, double *next) {
  if (!w->weight || component >= w->dimensions) return 0;
  const double push = w->time_step * sweep_force_part(w) * w->gravity[component];
  return add_push(at.end - at.first, push, w->limit[component],
                  w->weight + sweep_start(w, at.row) + at.first, next + at.first);
}

/* All components in one loop, with a literal number of them. */
static inline __attribute__((always_inline)) void drift(const sweep *w, int dof, row_part at,
                                                        const double *next) {
  const long start = sweep_start(w, at.row), pitch = w->lattice->pitch;
  const double step = w->time_step;
  INDEPENDENT
  for (long q = at.first; q < at.end; q++)
    for (int d = 0; d < dof; d++) {
      const double now = next[d * pitch + q];
      w->velocity[d][start + q] = now;
      w->displacement[d][start + q] += step * now;
    }
}

/* Sum of weight a b or, with `square`, of weight (a + b)^2; without weights they count as 1. Eight lanes, then their sum: the
   order is the same whatever the vector width. */
static inline __attribute__((always_inline)) double
lane_sum(long count, const double *restrict weight, const double *restrict a,
         const double *restrict b, bool square) {
  double lane[PL_LANES] = {0};
  for (long q = 0; q < count; q += PL_LANES)
    for (int l = 0; l < PL_LANES; l++) {
      const double both = a[q + l] + b[q + l], term = square ? both * both : a[q + l] * b[q + l];
      lane[l] += weight ? weight[q + l] * term : term;
    }
  double sum = 0;
  for (int l = 0; l < PL_LANES; l++)
    sum += lane[l];
  return sum;
}

/* Sum of m a b or m (a + b)^2 over particles, with m relative to their mean mass; literal choices make vectors. */
static double mass_sum(const sweep *w, row_part at, const double *a, const double *b, bool square) {
  const long count = at.end - at.first;
  const double *m = w->relative_mass;
  if (m) m += sweep_start(w, at.row) + at.first;
  if (!m) return square ? lane_sum(count, NULL, a, b, true) : lane_sum(count, NULL, a, b, false);
  return square ? lane_sum(count, m, a, b, true) : lane_sum(count, m, a, b, false);
}

double sweep_dot(long count, const double *a, const double *b) {
  return lane_sum(count, NULL, a, b, false);
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

void sweep_note_bad(const sweep *w, sweep_block *b, int row, long first) {
  const long start = sweep_start(w, row);
  w->row_stuck[row] = start + first;
  if (b->bad_site >= 0 && b->bad_site < start) return;
  for (long q = first; q < w->count[row]; q++)
    for (int d = 0; d < w->dof; d++) {
      const double v = b->next[d * w->lattice->pitch + q];
      if (fabs(v) < w->limit[d]) continue;
      b->bad_site = start + q;
      b->bad_component = d;
      b->bad_velocity = v;
      return;
    }
}

static void keep_ledger(sweep *w, const sweep_block *b, row_part at) {
  const long start = sweep_start(w, at.row) + at.first, count = at.end - at.first;
  for (int d = 0; d < w->dof; d++) {
    const double *next = b->next + d * w->lattice->pitch + at.first;
    if (w->decay < 1 && w->ledger)
      w->row_mass[at.row] +=
          0.5 * w->mass[d] * sweep_drag(w) * mass_sum(w, at, w->velocity[d] + start, next, true);
    if (w->weight && d < w->dimensions)
      w->row_gravity[at.row] +=
          w->gravity_work[d] * (w->relative_mass ? sweep_dot(count, w->relative_mass + start, next)
                                                 : sweep_total(count, next));
  }
}

void sweep_drift(sweep *w, sweep_block *b, row_part at) {
  if ((w->decay < 1 && w->ledger) || w->weight) keep_ledger(w, b, at);
  if (w->dof == 2)
    drift(w, 2, at, b->next);
  else
    drift(w, 3, at, b->next);
}

int sweep_bad(const sweep *w) {
  for (int k = 0; k < w->block_count; k++)
    if (w->blocks[k].bad_site >= 0) return k;
  return -1;
}

bool sweep_has_moved(const sweep *w, long site) {
  const long stuck = w->row_stuck[rows_row(w->lattice, site)];
  return stuck == 0 || site < stuck;
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

static void do_stages(sweep *w, int stages, void (*stage_of)(sweep *, int stage, int block)) {
#pragma omp parallel num_threads(w->block_count) if (w->block_count > 1)
  {
    const unsigned environment = sweep_enter();
    for (int stage = 0; stage < stages; stage++) {
#pragma omp for schedule(static)
      for (int block = 0; block < w->block_count; block++)
        stage_of(w, stage, block);
    }
    sweep_leave(environment);
  }
}

void sweep_find_forces(sweep *w) {
  do_stages(w, w->engine.force_stages, w->engine.forces);
}

/* --- sampling --------------------------------------------------------------------------------- */

void sweep_observe_motion(sweep *w, const sweep_block *b, int row) {
  const long start = sweep_start(w, row);
  const row_part all = whole_row(w, row);
  sweep_row *r = &w->observed[row];
  r->kinetic = r->free = r->mass = r->internal = 0;
  for (int d = 0; d < w->dof; d++) {
    const double *v = w->velocity[d] + start, *next = b->next + d * w->lattice->pitch;
    const double half = 0.5 * w->mass[d], square = mass_sum(w, all, v, v, false),
                 product = mass_sum(w, all, v, next, false);
    r->kinetic += half * product;
    r->mass += half * sweep_drag(w) * (square + product);
    const double work = -0.5 * w->time_step * sweep_dot(all.end, w->force[d] + start, v);
    r->internal += work;
    r->free += half * square - work;
  }
}

void sweep_observe(sweep *w) {
  do_stages(w, w->engine.observe_stages, w->engine.observe);
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
  sweep_totals t = {.internal = sum_of(w->row_internal, n), .dissipated = sum_of(w->row_mass, n)};
  if (w->weight) t.gravity = sum_of(w->row_gravity, n);
  for (int row = 0; row < n; row++) {
    const sweep_row *r = &w->observed[row];
    t.kinetic += r->kinetic;
    t.stored += r->stored;
    t.free += r->free;
    t.dissipated_state += r->state;
    t.dissipated_rate += r->rate;
    t.dissipated += r->mass;
    t.internal += r->internal;
  }
  return t;
}
