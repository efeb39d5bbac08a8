#include "runtime/sweep.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "dsl/arena.h"

#if defined(__clang__)
#define INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define INDEPENDENT _Pragma("GCC ivdep")
#endif

/* --- set-up ----------------------------------------------------------------------------------- */

static double *doubles(sweep *w, long count) {
  size_t bytes = (size_t)count * sizeof(double);
  bytes = (bytes + PL_ALIGNMENT - 1) / PL_ALIGNMENT * PL_ALIGNMENT;
  double *p = aligned_alloc(PL_ALIGNMENT, bytes ? bytes : PL_ALIGNMENT);
  if (!p) must_alloc(SIZE_MAX); /* ends the program with the usual message */
  memset(p, 0, bytes ? bytes : PL_ALIGNMENT);
  w->bytes += bytes;
  return p;
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

/* Bits of the lattice's bonds as strips have them. */
static void compose_flags(sweep *w) {
  const rows *g = w->lattice;
  w->flags = (int64_t *)doubles(w, g->size);
  for (long q = 0; q < g->size; q++)
    w->flags[q] = (int64_t)(g->bonds[q] | g->held_bonds[q] << 32);
}

static void prepare_uniforms(sweep *w, const double *parameters) {
  const int n = w->law->uniform_count;
  w->uniforms = doubles(w, (long)w->lattice->directions * n);
  for (int k = 0; k < w->lattice->directions; k++) {
    pl_bond_class c = rows_bond_class(w->lattice, k);
    w->law->prepare(w->law, parameters, &c, w->uniforms + (long)k * n);
  }
}

static void new_state(sweep *w, bool forces) {
  const rows *g = w->lattice;
  const long bonds = g->directions * g->size;
  for (int d = 0; d < w->dof; d++) {
    w->displacement[d] = doubles(w, g->size);
    w->velocity[d] = doubles(w, g->size);
    if (w->ledger || forces) w->force[d] = doubles(w, g->size);
  }
  w->field = must_calloc((size_t)w->law->field_count + 1, sizeof *w->field);
  for (int f = 0; f < w->law->field_count; f++) {
    w->field[f] = doubles(w, bonds);
    for (long b = 0; b < bonds; b++)
      w->field[f][b] = w->law->fields[f].initial;
  }
  if (w->ledger) {
    w->dissipated_state = doubles(w, g->size);
    w->dissipated_rate = doubles(w, g->size);
  }
  double **sums[] = {&w->row_kinetic, &w->row_stored, &w->row_mass, &w->row_pending};
  for (size_t k = 0; k < sizeof sums / sizeof *sums; k++)
    *sums[k] = doubles(w, g->row_count);
}

static void new_block(sweep *w, int block) {
  sweep_block *b = &w->blocks[block];
  const long pitch = w->lattice->pitch;
  const long buffer = w->law->force_planes * w->lattice->directions * w->stride;
  b->first = (int)((long)w->lattice->row_count * block / w->block_count);
  b->last = (int)((long)w->lattice->row_count * (block + 1) / w->block_count);
  b->buffer[0] = doubles(w, buffer);
  b->buffer[1] = doubles(w, buffer);
  b->seam = doubles(w, buffer);
  b->next = doubles(w, w->dof * pitch);
  b->fields = doubles(w, w->law->field_count * pitch);
  b->observed = doubles(w, (1 + w->law->output_count) * pitch);
  b->pointers =
      must_calloc((size_t)(w->law->field_count + w->law->output_count + 2), sizeof *b->pointers);
  b->parameters = must_calloc((size_t)w->law->varying_count + 1, sizeof *b->parameters);
  b->bad_site = -1;
}

sweep *sweep_new(const rows *lattice, const pl_law *law, const double *parameters, double time_step,
                 int threads, bool ledger, bool forces) {
  sweep *w = must_calloc(1, sizeof *w);
  assert(law->dimensions == 2 && law->force_planes <= PL_MAX_PLANES);
  assert(lattice->dimensions == 2 && lattice->directions == 3);
  w->lattice = lattice;
  w->law = law;
  w->time_step = time_step;
  w->decay = 1;
  w->ledger = ledger;
  w->dof = law->dof;
  for (int d = 0; d < w->dof; d++) {
    w->mass[d] = d < 2 ? lattice->mass : lattice->inertia;
    w->limit[d] = (d < 2 ? lattice->spacing : acos(-1)) / time_step;
  }
  w->stride = lattice->pitch + 2 * PL_LANES;
  find_spans(w);
  compose_flags(w);
  prepare_uniforms(w, parameters);
  new_state(w, forces);
  w->block_count = threads < lattice->row_count ? threads : lattice->row_count;
  if (w->block_count < 1) w->block_count = 1;
  w->blocks = must_calloc((size_t)w->block_count, sizeof *w->blocks);
  for (int k = 0; k < w->block_count; k++)
    new_block(w, k);
  return w;
}

void sweep_add_gravity(sweep *w) {
  w->weight = doubles(w, w->lattice->size);
  for (long q = 0; q < w->lattice->size; q++)
    w->weight[q] = w->lattice->present[q] ? 1 : 0;
  w->row_gravity = doubles(w, w->lattice->row_count);
}

static void free_block(sweep_block *b) {
  free(b->buffer[0]);
  free(b->buffer[1]);
  free(b->seam);
  free(b->next);
  free(b->fields);
  free(b->observed);
  free(b->pointers);
  free(b->parameters);
}

void sweep_free(sweep *w) {
  if (!w) return;
  for (int k = 0; k < w->block_count; k++)
    free_block(&w->blocks[k]);
  for (int d = 0; d < w->dof; d++) {
    free(w->displacement[d]);
    free(w->velocity[d]);
    free(w->force[d]);
  }
  for (int f = 0; f < w->law->field_count; f++)
    free(w->field[f]);
  free(w->field);
  free(w->uniforms);
  free(w->flags);
  free(w->dissipated_state);
  free(w->dissipated_rate);
  free(w->row_kinetic);
  free(w->row_stored);
  free(w->row_mass);
  free(w->row_pending);
  free(w->row_gravity);
  free(w->weight);
  free(w->begin);
  free(w->count);
  free(w->blocks);
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

/* --- bonds of a row --------------------------------------------------------------------------- */

static double *plane(const sweep *w, double *buffer, int p, int direction) {
  return buffer + ((long)p * w->lattice->directions + direction) * w->stride + PL_LANES;
}

/* A buffer's places outside the row's span keep forces of an earlier row: they count as absent
 * bonds. */
static void clear_outside(const sweep *w, int row, double *strip) {
  const long begin = w->begin[row], end = begin + w->count[row];
  memset(strip, 0, (size_t)begin * sizeof *strip);
  memset(strip + end, 0, (size_t)(w->lattice->pitch - end) * sizeof *strip);
}

static void strip_ends(const sweep *w, sweep_block *b, int row, int direction, pl_strip *s) {
  const rows *g = w->lattice;
  const long near = rows_start(g, row) + w->begin[row], far = near + rows_offset(g, row, direction);
  s->count = w->count[row];
  s->direction = direction;
  s->flags = w->flags + near;
  s->time_step = w->time_step;
  s->parameter = b->parameters;
  for (int k = 0; k < w->law->varying_count; k++)
    b->parameters[k] = w->parameter[k] + direction * g->size + near;
  for (int d = 0; d < w->dof; d++) {
    s->displacement_i[d] = w->displacement[d] + near;
    s->displacement_j[d] = w->displacement[d] + far;
    s->velocity_i[d] = w->velocity[d] + near;
    s->velocity_j[d] = w->velocity[d] + far;
  }
  if (w->ledger) {
    s->dissipated_state = w->dissipated_state + near;
    s->dissipated_rate = w->dissipated_rate + near;
  }
}

static const double *uniforms_of(const sweep *w, int direction) {
  return w->uniforms + (long)direction * w->law->uniform_count;
}

/* Forces of the bonds that row `row` owns, into `buffer`; their fields move on by one step. */
static void evaluate(sweep *w, sweep_block *b, int row, double *buffer) {
  const rows *g = w->lattice;
  const pl_strip_function kernel = w->ledger ? w->law->rows_ledger : w->law->rows;
  for (int k = 0; k < g->directions; k++) {
    double *force[PL_MAX_PLANES];
    for (int p = 0; p < w->law->force_planes; p++) {
      clear_outside(w, row, plane(w, buffer, p, k));
      force[p] = plane(w, buffer, p, k) + w->begin[row];
    }
    if (w->count[row] == 0) continue;
    for (int f = 0; f < w->law->field_count; f++)
      b->pointers[f] = w->field[f] + k * g->size + rows_start(g, row) + w->begin[row];
    pl_strip s = {.field = b->pointers, .force = force};
    strip_ends(w, b, row, k, &s);
    kernel(w->law, uniforms_of(w, k), &s);
  }
}

/* The same on a copy of the fields: forces of the present state without a trace. */
static void evaluate_aside(sweep *w, sweep_block *b, int row, double *buffer) {
  const rows *g = w->lattice;
  for (int k = 0; k < g->directions; k++) {
    double *force[PL_MAX_PLANES];
    for (int p = 0; p < w->law->force_planes; p++) {
      clear_outside(w, row, plane(w, buffer, p, k));
      force[p] = plane(w, buffer, p, k) + w->begin[row];
    }
    if (w->count[row] == 0) continue;
    for (int f = 0; f < w->law->field_count; f++) {
      b->pointers[f] = b->fields + f * g->pitch;
      memcpy(b->pointers[f], w->field[f] + k * g->size + rows_start(g, row) + w->begin[row],
             (size_t)w->count[row] * sizeof(double));
    }
    pl_strip s = {.field = b->pointers, .force = force};
    strip_ends(w, b, row, k, &s);
    w->law->rows(w->law, uniforms_of(w, k), &s);
  }
}

/* --- particles of a row ----------------------------------------------------------------------- */

enum { MOST_DIRECTIONS = 3 }; /* of a law of bonds */

typedef struct gathered { /* bond forces that add up to the force on the particles of a row, by
                             direction */
  const double *own[MOST_DIRECTIONS], *incoming[MOST_DIRECTIONS];
} gathered;

/* Incoming bonds along the row stand in this row's buffer, those from the row below in the other.
 */
static gathered gather(const sweep *w, int row, int component, double *here, double *below) {
  const rows *g = w->lattice;
  const int far_plane = component < 2 ? component : 3;
  const long begin = w->begin[row];
  gathered s = {{0}, {0}};
  for (int k = 0; k < g->directions; k++) {
    const long along = rows_offset(g, row, k), up = rows_offset(g, row - 1, k);
    s.own[k] = plane(w, here, component, k) + begin;
    s.incoming[k] = along < g->pitch / 2 ? plane(w, here, far_plane, k) + begin - along
                                         : plane(w, below, far_plane, k) + begin - (up - g->pitch);
  }
  return s;
}

static inline __attribute__((always_inline)) double bond_sum(const gathered *s, int directions,
                                                             double sign, long q) {
  double f = s->own[0][q];
  for (int k = 1; k < directions; k++)
    f += s->own[k][q];
  for (int k = 0; k < directions; k++)
    f += sign * s->incoming[k][q];
  return f;
}

/* next = decay v + dt/m f. Returns nonzero when a velocity is not below the limit (NaN is not below
 * anything). */
static inline __attribute__((always_inline)) int64_t
kick(const gathered *from, int directions, double sign, long count, double kick_factor,
     double decay, double limit, const double *restrict v, double *restrict next) {
  const gathered s = *from;
  int64_t bad = 0;
  INDEPENDENT
  for (long q = 0; q < count; q++) {
    const double after = decay * v[q] + kick_factor * bond_sum(&s, directions, sign, q);
    next[q] = after;
    bad |= __builtin_fabs(after) < limit ? INT64_C(0) : INT64_C(1);
  }
  return bad;
}

/* What gravity adds, and the same test of what it makes. Absent sites have no weight: they stay
   where they are. */
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

/* Literal directions and signs let the compiler unroll and vectorise. Moments come signed by end,
   forces on j are the opposite of those on i. */
static int64_t kick_component(const sweep *w, const gathered *s, int d, long count, const double *v,
                              double *next) {
  const double factor = w->time_step / w->mass[d];
  if (d >= 2) return kick(s, 3, 1, count, factor, w->decay, w->limit[d], v, next);
  const int64_t bad = kick(s, 3, -1, count, factor, w->decay, w->limit[d], v, next);
  if (!w->weight) return bad;
  return add_push(count, w->push[d], w->limit[d], w->weight + (v - w->velocity[d]), next);
}

static void drift(long count, double time_step, const double *restrict next, double *restrict v,
                  double *restrict u) {
  INDEPENDENT
  for (long q = 0; q < count; q++) {
    v[q] = next[q];
    u[q] += time_step * next[q];
  }
}

/* Sum of a (a + b) in an order of its own: eight lanes, then their sum, whatever the vector width.
 */
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

static double lane_total(long count, const double *restrict a) {
  double lane[PL_LANES] = {0};
  for (long q = 0; q < count; q += PL_LANES)
    for (int l = 0; l < PL_LANES; l++)
      lane[l] += a[q + l];
  double sum = 0;
  for (int l = 0; l < PL_LANES; l++)
    sum += lane[l];
  return sum;
}

static void note_bad(const sweep *w, sweep_block *b, int row) {
  if (b->bad_site >= 0) return;
  for (long q = 0; q < w->count[row]; q++)
    for (int d = 0; d < w->dof; d++) {
      const double v = b->next[d * w->lattice->pitch + q];
      if (fabs(v) < w->limit[d]) continue;
      b->bad_site = rows_start(w->lattice, row) + w->begin[row] + q;
      b->bad_component = d;
      b->bad_velocity = v;
      return;
    }
}

/* Moves a row. A row with a bad velocity stays where it is, so that its state before the step can
 * be reported. */
static void move_row(sweep *w, sweep_block *b, int row, double *here, double *below) {
  const long start = rows_start(w->lattice, row) + w->begin[row], count = w->count[row];
  int64_t bad = 0;
  for (int d = 0; d < w->dof; d++) {
    const gathered s = gather(w, row, d, here, below);
    bad |= kick_component(w, &s, d, count, w->velocity[d] + start, b->next + d * w->lattice->pitch);
  }
  if (bad) {
    note_bad(w, b, row);
    return;
  }
  for (int d = 0; d < w->dof; d++) {
    double *next = b->next + d * w->lattice->pitch, *v = w->velocity[d] + start;
    if (w->decay < 1 && w->ledger)
      w->row_mass[row] += 0.5 * w->mass[d] * (1 - w->decay) * lane_sum(count, v, next, true);
    if (w->weight && d < 2) w->row_gravity[row] += w->push_work[d] * lane_total(count, next);
    drift(count, w->time_step, next, v, w->displacement[d] + start);
  }
}

void sweep_seam(sweep *w, int block) {
  sweep_block *b = &w->blocks[block];
  b->bad_site = -1;
  evaluate(w, b, b->last - 1, b->seam);
}

void sweep_rows(sweep *w, int block) {
  sweep_block *b = &w->blocks[block];
  double *below = block > 0 ? w->blocks[block - 1].seam : b->buffer[1];
  if (block == 0) /* nothing below the first row */
    memset(below, 0,
           (size_t)(w->law->force_planes * w->lattice->directions * w->stride) * sizeof *below);
  for (int r = b->first; r < b->last; r++) {
    double *here = r == b->last - 1 ? b->seam : b->buffer[(r - b->first) & 1];
    if (here != b->seam) evaluate(w, b, r, here);
    move_row(w, b, r, here, below);
    below = here;
  }
}

int sweep_bad(const sweep *w) {
  for (int k = 0; k < w->block_count; k++)
    if (w->blocks[k].bad_site >= 0) return k;
  return -1;
}

/* --- sampling --------------------------------------------------------------------------------- */

/* Stored energy and outputs of a row's bonds of one direction, into the block's `observed`. */
static pl_strip observe_strip(sweep *w, sweep_block *b, int row, int direction) {
  const rows *g = w->lattice;
  double **observed = b->pointers + w->law->field_count;
  for (int f = 0; f < w->law->field_count; f++)
    b->pointers[f] = w->field[f] + direction * g->size + rows_start(g, row) + w->begin[row];
  for (int o = 0; o <= w->law->output_count; o++)
    observed[o] = b->observed + o * g->pitch;
  pl_strip s = {.field = b->pointers, .observed = observed};
  strip_ends(w, b, row, direction, &s);
  w->law->rows_observe(w->law, uniforms_of(w, direction), &s);
  return s;
}

static double stored_in_row(sweep *w, sweep_block *b, int row) {
  double sum = 0;
  for (int k = 0; k < w->lattice->directions && w->count[row] > 0; k++) {
    const pl_strip s = observe_strip(w, b, row, k);
    for (long q = 0; q < s.count; q++)
      if (s.flags[q] & PL_PRESENT(k)) sum += b->observed[q];
  }
  return sum;
}

void sweep_output(sweep *w, int output, double *values) {
  const rows *g = w->lattice;
  sweep_block *b = &w->blocks[0];
  for (int r = 0; r < g->row_count; r++)
    for (int k = 0; k < g->directions && w->count[r] > 0; k++) {
      const pl_strip s = observe_strip(w, b, r, k);
      memcpy(values + k * g->size + rows_start(g, r) + w->begin[r],
             b->observed + (1 + output) * g->pitch, (size_t)s.count * sizeof *values);
    }
}

static void observe_row(sweep *w, sweep_block *b, int row, double *here, double *below) {
  const long start = rows_start(w->lattice, row) + w->begin[row], count = w->count[row];
  w->row_kinetic[row] = 0;
  w->row_pending[row] = 0;
  for (int d = 0; d < w->dof; d++) {
    const gathered s = gather(w, row, d, here, below);
    const double *v = w->velocity[d] + start;
    double *next = b->next + d * w->lattice->pitch;
    kick_component(w, &s, d, count, v, next);
    for (long q = 0; q < count; q++)
      w->force[d][start + q] = bond_sum(&s, w->lattice->directions, d < 2 ? -1 : 1, q);
    w->row_kinetic[row] += 0.5 * w->mass[d] * lane_sum(count, v, next, false);
    if (w->decay < 1)
      w->row_pending[row] += 0.5 * w->mass[d] * (1 - w->decay) * lane_sum(count, v, v, false);
  }
  w->row_stored[row] = w->ledger ? stored_in_row(w, b, row) : 0;
}

void sweep_observe(sweep *w, int block) {
  sweep_block *b = &w->blocks[block];
  double *below = b->buffer[1];
  memset(below, 0,
         (size_t)(w->law->force_planes * w->lattice->directions * w->stride) * sizeof *below);
  if (b->first > 0) evaluate_aside(w, b, b->first - 1, below);
  for (int r = b->first; r < b->last; r++) {
    double *here = b->buffer[(r - b->first) & 1];
    evaluate_aside(w, b, r, here);
    observe_row(w, b, r, here, below);
    below = here;
  }
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
                    .dissipated_mass = sum_of(w->row_mass, n),
                    .dissipated_pending = sum_of(w->row_pending, n)};
  if (w->weight) t.gravity = sum_of(w->row_gravity, n);
  if (w->ledger) {
    t.dissipated_state = sum_of(w->dissipated_state, w->lattice->size);
    t.dissipated_rate = sum_of(w->dissipated_rate, w->lattice->size);
  }
  return t;
}
