#include "runtime/interaction/pairwise.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/base/clock.h"
#include "runtime/base/lane_sum.h"
#include "runtime/base/team.h"
#include "runtime/body/motion.h"

enum {
  DIRECTIONS = 3,       /* of a law of bonds */
  FAR_BYTES = 32 << 20, /* of the state of a body, from which on caches do not hold enough of it */
  LONGEST_PART = 160    /* bonds of a direction that are looked at before those of the next */
};

/* Bond forces of one row. Only the places from `begin` to `end` of a row are not zero. */
typedef struct row_forces {
  double *values; /* [planes][directions][stride] */
  long begin, end;
} row_forces;

typedef struct pairwise_block { /* what one thread works with */
  row_forces buffer[2];
  row_forces seam;           /* of the last row: the block above needs them, too */
  team_errand seam_done;     /* once a step */
  double *fields;            /* [fields][pitch] copy of those of another block's row */
  double *observed;          /* [1 + outputs][pitch] */
  double **pointers;         /* of fields and observed values, for strips */
  const double **parameters; /* [varying] for strips */
  char apart[BODY_APART];
} pairwise_block;

typedef struct pairwise {
  double *uniforms; /* [directions][uniform_count] */
  int64_t **flags;  /* [row_count] of the bonds that the sites of a row's span own */
  int64_t *some;    /* [row_count] the flags of all these bonds together */
  long stride;      /* doubles of a direction in a buffer */
  long buffer;      /* doubles of a buffer */
  /* What a row is the first to read, by its sites: states of its bonds, motions of the row above.
     None where a body fits into caches. */
  const double **streams;
  int stream_count;
  long steps;             /* done */
  pairwise_block *blocks; /* [block_count] */
} pairwise;

static pairwise *own(const sweep *w) {
  return w->engine.own;
}

/* --- bonds of a row --------------------------------------------------------------------------- */

static double *plane(const sweep *w, const row_forces *buffer, int p, int direction) {
  return buffer->values + ((long)p * w->body->lattice->directions + direction) * own(w)->stride +
         PL_LANES;
}

/* Prepares a buffer for another row: what an earlier row left outside the span of this one counts
   as absent bonds. Most rows are as long as the one before, and nothing is to be done. */
static void take_buffer(const sweep *w, row_forces *buffer, long begin, long end) {
  const long low = begin - buffer->begin, high = buffer->end - end;
  for (int p = 0; p < w->law->force_planes && (low > 0 || high > 0); p++)
    for (int k = 0; k < w->body->lattice->directions; k++) {
      double *values = plane(w, buffer, p, k);
      if (low > 0) memset(values + buffer->begin, 0, (size_t)low * sizeof *values);
      if (high > 0) memset(values + end, 0, (size_t)high * sizeof *values);
    }
  buffer->begin = begin;
  buffer->end = end;
}

static void take_buffer_for_row(const sweep *w, row_forces *buffer, int row) {
  take_buffer(w, buffer, w->body->begin[row], w->body->begin[row] + w->body->count[row]);
}

static void clear_buffer(const sweep *w, row_forces *buffer) {
  take_buffer(w, buffer, buffer->end, buffer->end);
}

/* Bonds that a row owns in one direction, from place `first` of its span on. */
static void strip_ends(const sweep *w, pairwise_block *b, int row, int direction, long first,
                       long count, pl_strip *s) {
  const rows *g = w->body->lattice;
  const long near = body_start(w->body, row) + first, far = near + rows_offset(g, row, direction);
  s->count = count;
  s->direction = direction;
  s->flags = own(w)->flags[row] + first;
  s->unheld = (own(w)->some[row] & PL_PROTECTED(direction)) == 0;
  s->time = w->body->time;
  s->time_step = w->body->time_step;
  s->advance = w->body->advance;
  s->parameter = b->parameters;
  for (int k = 0; k < w->law->varying_count; k++)
    b->parameters[k] = w->parameter[k] + direction * g->size + near;
  for (int d = 0; d < w->body->dof; d++) {
    s->displacement_i[d] = w->body->displacement[d] + near;
    s->displacement_j[d] = w->body->displacement[d] + far;
    s->velocity_i[d] = w->body->velocity[d] + near;
    s->velocity_j[d] = w->body->velocity[d] + far;
  }
  if (w->body->ledger) {
    s->dissipated_state = w->dissipated_state + near;
    s->dissipated_rate = w->dissipated_rate + near;
    if (w->given_by_rest) s->given_by_rest = w->given_by_rest + near;
  }
}

const double *pairwise_uniforms(const sweep *w, int direction) {
  return own(w)->uniforms + (long)direction * w->law->uniform_count;
}

/* Forces of the bonds that a row owns in one direction, from place `first` on, into `buffer`; their
   fields move on by one step. */
static void evaluate_strip(sweep *w, pairwise_block *b, int row, int direction, long first,
                           long count, const row_forces *buffer) {
  double *force[PL_MAX_PLANES];
  const long begin = w->body->begin[row] + first,
             site = direction * w->body->lattice->size + rows_start(w->body->lattice, row) + begin;
  for (int p = 0; p < w->law->force_planes; p++)
    force[p] = plane(w, buffer, p, direction) + begin;
  for (int f = 0; f < w->law->field_count; f++)
    b->pointers[f] = w->field[f] + site;
  pl_strip s = {.size = sizeof s, .field = b->pointers, .force = force};
  strip_ends(w, b, row, direction, first, count, &s);
  const pl_strip_function kernel = w->body->ledger ? w->law->rows_ledger : w->law->rows;
  kernel(w->law, pairwise_uniforms(w, direction), &s);
}

/* Asks for `count` doubles, to be read or to be written. Inlined, as compilers leave out calls that
   seem to do nothing. */
static inline __attribute__((always_inline)) void fetch(const double *from, long count,
                                                        bool to_write) {
  enum { SECOND_CACHE = 2 };
  for (long q = 0; q < count; q += PL_LANES) {
    if (to_write)
      __builtin_prefetch(from + q, 1);
    else
      __builtin_prefetch(from + q, 0, SECOND_CACHE);
  }
}

/* A third of what the part after this one is the first to read: a processor waits for few lines at
   a time. */
static inline __attribute__((always_inline)) void fetch_ahead(const sweep *w, row_part at,
                                                              int direction) {
  const pairwise *p = own(w);
  const long site = body_start(w->body, at.row) + at.first + LONGEST_PART,
             count = at.end - at.first;
  for (int s = direction; s < p->stream_count; s += DIRECTIONS)
    fetch(p->streams[s] + site, count, false);
}

/* Forces of the bonds that the sites of a part own. */
static void evaluate_part(sweep *w, pairwise_block *b, row_part at, const row_forces *buffer) {
  for (int k = 0; k < DIRECTIONS; k++) {
    fetch_ahead(w, at, k);
    evaluate_strip(w, b, at.row, k, at.first, at.end - at.first, buffer);
  }
}

/* The same on a copy of the fields: forces and new fields of the present state. Of a row of another
   block, whose first row needs them, only the forces are kept. */
static void evaluate_aside(sweep *w, int block, int row, row_forces *buffer) {
  const rows *g = w->body->lattice;
  pairwise_block *b = &own(w)->blocks[block];
  const bool foreign = row < w->body->blocks[block].first, ledger = w->body->ledger && !foreign;
  const long start = body_start(w->body, row);
  take_buffer_for_row(w, buffer, row);
  if (ledger) sweep_clear_losses(w, row);
  for (int k = 0; k < g->directions && w->body->count[row] > 0; k++) {
    double *force[PL_MAX_PLANES];
    for (int p = 0; p < w->law->force_planes; p++)
      force[p] = plane(w, buffer, p, k) + w->body->begin[row];
    for (int f = 0; f < w->law->field_count; f++) {
      b->pointers[f] = foreign ? b->fields + f * g->pitch : w->new_field[f] + k * g->size + start;
      memcpy(b->pointers[f], w->field[f] + k * g->size + start,
             (size_t)w->body->count[row] * sizeof(double));
    }
    pl_strip s = {.size = sizeof s, .field = b->pointers, .force = force};
    strip_ends(w, b, row, k, 0, w->body->count[row], &s);
    if (ledger) {
      s.dissipated_state = w->lost_state + start;
      s.dissipated_rate = w->lost_rate + start;
      if (w->given_now) s.given_by_rest = w->given_now + start;
    }
    (ledger ? w->law->rows_ledger : w->law->rows)(w->law, pairwise_uniforms(w, k), &s);
  }
}

const int64_t *pairwise_flags(const sweep *w, int row) {
  return own(w)->flags[row];
}

/* --- particles of a row ----------------------------------------------------------------------- */

/* Where bond forces stand that add up to those on the particles of a row: in plane 0; those of
   direction k that the row owns k strides further on, the other planes `plane` further on. */
typedef struct gathered {
  const double *own, *incoming[DIRECTIONS];
  long stride, plane;
} gathered;

/* Incoming bonds along the row stand in this row's buffer, those from the row below in the other.
   */
static gathered gather(const sweep *w, int row, const row_forces *here, const row_forces *below) {
  const rows *g = w->body->lattice;
  const long begin = w->body->begin[row], stride = own(w)->stride;
  gathered s = {
      .own = plane(w, here, 0, 0) + begin, .stride = stride, .plane = DIRECTIONS * stride};
  for (int k = 0; k < DIRECTIONS; k++) {
    const long along = rows_offset(g, row, k), up = rows_offset(g, row - 1, k);
    s.incoming[k] = along < g->pitch / 2 ? plane(w, here, 0, k) + begin - along
                                         : plane(w, below, 0, k) + begin - (up - g->pitch);
  }
  return s;
}

/* Of what bonds exert on the particle at q: forces on j are the opposite of those on i, moments are
   alike. */
static inline __attribute__((always_inline)) double bond_sum(const gathered *s, int component,
                                                             long q) {
  const long near = component * s->plane, far = (component < 2 ? component : 3) * s->plane;
  const double sign = component < 2 ? -1 : 1;
  double f = s->own[near + q];
  for (int k = 1; k < DIRECTIONS; k++)
    f += s->own[near + k * s->stride + q];
  for (int k = 0; k < DIRECTIONS; k++)
    f += sign * s->incoming[k][far + q];
  return f;
}

/* Bits of |x|, which are in the order of the sizes, and of NaN above those of all numbers. */
static inline uint64_t size_bits(double x) {
  union {
    double value;
    uint64_t bits;
  } u = {.value = __builtin_fabs(x)};
  return u.bits;
}

/* next = decay v + part dt/m f (motion.h) in all components, from place `first` of a row on. Not 0
   when a velocity is not below its limit (NaN is not below anything). One loop whose choices are
   literal: that is what compilers make vectors of. */
static inline __attribute__((always_inline)) int64_t kick(const body *w, const gathered *from,
                                                          int dof, bool decays, bool each_mass,
                                                          row_part at, double *next) {
  const long start = body_start(w, at.row), pitch = w->lattice->pitch;
  const double decay = w->decay, step = motion_force_part(w) * w->time_step;
  const double factor[] = {step / w->mass[0], step / w->mass[1], -step / w->mass[dof - 1]};
  const double *moves = each_mass ? w->mobility[0] + start : NULL,
               *turns = each_mass && dof > 2 ? w->mobility[1] + start : NULL;
  const gathered s = *from;
  uint64_t largest[] = {0, 0, 0};
  INDEPENDENT
  for (long q = at.first; q < at.end; q++)
    for (int d = 0; d < dof; d++) {
      const double v = w->velocity[d][start + q];
      const double part = !each_mass ? factor[d] : factor[d] * (d < 2 ? moves : turns)[q];
      const double after = (decays ? decay * v : v) + part * bond_sum(&s, d, q);
      const uint64_t size = size_bits(after);
      next[d * pitch + q] = after;
      largest[d] = largest[d] > size ? largest[d] : size;
    }
  int64_t bad = 0;
  for (int d = 0; d < dof; d++)
    bad |= largest[d] >= size_bits(w->limit[d]);
  return bad;
}

/* Particles receive the opposite of end moments. */
static inline __attribute__((always_inline)) int64_t
kick_components(const body *w, const gathered *from, int dof, row_part at, double *next) {
  const bool decays = w->decay != 1;
  if (w->mobility[0])
    return decays ? kick(w, from, dof, true, true, at, next)
                  : kick(w, from, dof, false, true, at, next);
  return decays ? kick(w, from, dof, true, false, at, next)
                : kick(w, from, dof, false, false, at, next);
}

static int64_t kick_part(const body *w, const gathered *from, row_part at, double *next) {
  return w->dof == 2 ? kick_components(w, from, 2, at, next)
                     : kick_components(w, from, 3, at, next);
}

/* A row on its way. */
typedef struct moved_row {
  int row;
  bool known; /* the forces of its bonds are */
  gathered from;
  long moved; /* places that are, from the first on */
} moved_row;

/* Moves a part whose forces are known. A part with a bad velocity stays where it is, and so does
   what follows in its row: the state before the step can be reported. */
static void move_part(body *w, body_block *b, moved_row *m, row_part at) {
  const double begun = w->timed ? monotonic_seconds() : 0;
  int64_t bad = kick_part(w, &m->from, at, b->next);
  for (int d = 0; d < w->dimensions && body_is_pushed(w); d++)
    bad |= motion_push(w, &at, d, b->next + d * w->lattice->pitch);
  if (!bad && m->moved == at.first) {
    motion_drift(w, b, &at);
    m->moved = at.end;
  }
  if (w->timed) b->moving += monotonic_seconds() - begun;
}

/* Equal parts of a row of that many places, whole vectors. */
static long part_of(long count) {
  const long parts = (count + LONGEST_PART - 1) / LONGEST_PART;
  return parts ? (count / parts + PL_LANES - 1) / PL_LANES * PL_LANES : 0;
}

/* A row that another processor has been at: all its lines at once, as they come slowly. */
static inline __attribute__((always_inline)) void fetch_row(const body *w, int row, bool to_write) {
  for (int d = 0; d < w->dof; d++) {
    fetch(w->displacement[d] + body_start(w, row), w->count[row], to_write);
    fetch(w->velocity[d] + body_start(w, row), w->count[row], to_write);
  }
}

/* The bonds of a block's last row, before it or the row above moves: the first row of the next
   block waits for them. */
static void need_seam(sweep *w, int block) {
  pairwise_block *p = &own(w)->blocks[block];
  const int row = w->body->blocks[block].last - 1;
  if (!team_is_first(&p->seam_done, own(w)->steps)) return;
  if (block + 1 < w->body->block_count) fetch_row(w->body, row + 1, false);
  take_buffer_for_row(w, &p->seam, row);
  if (w->body->count[row] > 0) evaluate_part(w, p, whole_row(w->body, row), &p->seam);
  team_did(&p->seam_done, own(w)->steps);
}

/* A row's particles by one step, part by part: what the bonds of one direction have brought into
   the first cache is there for those of the next, and their forces for the particles. */
static void advance_row(sweep *w, int block, moved_row *m, const row_forces *here) {
  body_block *b = &w->body->blocks[block];
  const long count = w->body->count[m->row], part = part_of(count);
  for (long first = 0; first < count; first += part) {
    const row_part at = {m->row, first, first + part < count ? first + part : count};
    if (!m->known) evaluate_part(w, &own(w)->blocks[block], at, here);
    if (m->row == b->first && block > 0 && first == 0) {
      need_seam(w, block - 1);
      fetch_row(w->body, m->row, true);
    }
    move_part(w->body, b, m, at);
  }
  if (m->moved < count) motion_note_bad(w->body, b, m->row, m->moved);
}

static void step(sweep *w, int stage, int block) {
  (void)stage; /* there is one */
  body_block *b = &w->body->blocks[block];
  pairwise_block *p = &own(w)->blocks[block];
  row_forces *below = block > 0 ? &own(w)->blocks[block - 1].seam : &p->buffer[1];
  if (block == 0) clear_buffer(w, below); /* nothing below the first row */
  b->bad_site = -1;
  need_seam(w, block);
  for (int r = b->first; r < b->last; r++) {
    moved_row m = {.row = r, .known = r == b->last - 1};
    row_forces *here = m.known ? &p->seam : &p->buffer[(r - b->first) & 1];
    if (!m.known) take_buffer_for_row(w, here, r);
    m.from = gather(w, r, here, below);
    advance_row(w, block, &m, here);
    below = here;
  }
}

static void turn(sweep *w) {
  own(w)->steps++;
}

/* --- sampling --------------------------------------------------------------------------------- */

/* Stored energy and outputs of a row's bonds of one direction, into the block's `observed`. */
static pl_strip observe_strip(sweep *w, pairwise_block *b, int row, int direction) {
  const rows *g = w->body->lattice;
  double **observed = b->pointers + w->law->field_count;
  for (int f = 0; f < w->law->field_count; f++)
    b->pointers[f] = w->new_field[f] + direction * g->size + body_start(w->body, row);
  for (int o = 0; o <= w->law->output_count; o++)
    observed[o] = b->observed + o * g->pitch;
  pl_strip s = {.size = sizeof s, .field = b->pointers, .observed = observed};
  strip_ends(w, b, row, direction, 0, w->body->count[row], &s);
  w->law->rows_observe(w->law, pairwise_uniforms(w, direction), &s);
  return s;
}

static double stored_in_row(sweep *w, pairwise_block *b, int row) {
  double sum = 0;
  for (int k = 0; k < w->body->lattice->directions && w->body->count[row] > 0; k++) {
    const pl_strip s = observe_strip(w, b, row, k);
    for (long q = 0; q < s.count; q++)
      if (s.flags[q] & PL_PRESENT(k)) sum += b->observed[q];
  }
  return sum;
}

static void output_values(sweep *w, int output, double *values) {
  const rows *g = w->body->lattice;
  pairwise_block *b = &own(w)->blocks[0];
  for (int r = 0; r < g->row_count; r++)
    for (int k = 0; k < g->directions && w->body->count[r] > 0; k++) {
      const pl_strip s = observe_strip(w, b, r, k);
      memcpy(values + k * g->size + rows_start(g, r) + w->body->begin[r],
             b->observed + (1 + output) * g->pitch, (size_t)s.count * sizeof *values);
    }
}

static void stored_values(sweep *w, double *values) {
  const rows *g = w->body->lattice;
  pairwise_block *b = &own(w)->blocks[0];
  memset(values, 0, (size_t)g->size * sizeof *values);
  for (int r = 0; r < g->row_count; r++)
    for (int k = 0; k < g->directions && w->body->count[r] > 0; k++) {
      const pl_strip s = observe_strip(w, b, r, k);
      const long near = body_start(w->body, r), far = near + rows_offset(g, r, k);
      for (long q = 0; q < s.count; q++) {
        if (!(s.flags[q] & PL_PRESENT(k))) continue;
        values[near + q] += 0.5 * b->observed[q];
        values[far + q] += 0.5 * b->observed[q];
      }
    }
}

static void observe_row(sweep *w, int block, int row, const row_forces *here,
                        const row_forces *below) {
  body_block *b = &w->body->blocks[block];
  const long start = body_start(w->body, row), count = w->body->count[row];
  const row_part whole = whole_row(w->body, row);
  const gathered from = gather(w, row, here, below);
  kick_part(w->body, &from, whole, b->next);
  for (int d = 0; d < w->body->dof; d++) {
    motion_push(w->body, &whole, d, b->next + d * w->body->lattice->pitch);
    for (long q = 0; q < count; q++)
      w->body->force[d][start + q] = d < 2 ? bond_sum(&from, d, q) : -bond_sum(&from, 2, q);
  }
  motion_observe(w->body, b, row);
  if (!w->body->ledger) return;
  w->body->observed[row].stored = stored_in_row(w, &own(w)->blocks[block], row);
  sweep_add_losses(w, row);
}

static void observe(sweep *w, int stage, int block) {
  (void)stage; /* there is one */
  const body_block *b = &w->body->blocks[block];
  pairwise_block *p = &own(w)->blocks[block];
  row_forces *below = &p->buffer[1];
  clear_buffer(w, below);
  if (b->first > 0) evaluate_aside(w, block, b->first - 1, below);
  for (int r = b->first; r < b->last; r++) {
    row_forces *here = &p->buffer[(r - b->first) & 1];
    evaluate_aside(w, block, r, here);
    observe_row(w, block, r, here, below);
    below = here;
  }
}

/* --- set-up ----------------------------------------------------------------------------------- */

static void prepare_uniforms(sweep *w, pairwise *p, const double *parameters) {
  const int n = w->law->uniform_count;
  p->uniforms = body_doubles(w->body, (long)w->body->lattice->directions * n);
  for (int k = 0; k < w->body->lattice->directions; k++) {
    pl_bond_class c = rows_bond_class(w->body->lattice, k);
    w->law->prepare(w->law, parameters, &c, p->uniforms + (long)k * n);
  }
}

/* Bits of the bonds that a row's sites own. */
static void read_flags(const sweep *w, int row, int64_t *flags) {
  const rows *g = w->body->lattice;
  const long start = body_start(w->body, row);
  for (long q = 0; q < w->body->count[row]; q++)
    flags[q] = (int64_t)(g->bonds[start + q] | g->held_bonds[start + q] << 32);
}

/* Most rows of a body are as the row two below: these share what they have, so that it stays in a
   cache. */
static void compose_flags(sweep *w, pairwise *p) {
  const rows *g = w->body->lattice;
  int64_t *read = must_calloc((size_t)g->pitch, sizeof *read);
  p->flags = must_calloc((size_t)g->row_count, sizeof *p->flags);
  p->some = must_calloc((size_t)g->row_count, sizeof *p->some);
  for (int r = 0; r < g->row_count; r++) {
    const size_t bytes = (size_t)w->body->count[r] * sizeof *read;
    int64_t *same = r >= 2 && w->body->count[r - 2] == w->body->count[r] ? p->flags[r - 2] : NULL;
    read_flags(w, r, read);
    for (long q = 0; q < w->body->count[r]; q++)
      p->some[r] |= read[q];
    if (same && memcmp(same, read, bytes) != 0) same = NULL;
    p->flags[r] = same ? same : memcpy(body_doubles(w->body, w->body->count[r]), read, bytes);
  }
  free(read);
}

/* In an order in which thirds (fetch_ahead) are alike. */
static void list_streams(const sweep *w, pairwise *p) {
  const rows *g = w->body->lattice;
  const int most = DIRECTIONS * w->law->field_count + 2 * w->body->dof + 2;
  p->streams = must_calloc((size_t)most, sizeof *p->streams);
  if (w->body->bytes < (size_t)FAR_BYTES) return;
  for (int f = 0; f < w->law->field_count; f++)
    for (int k = 0; k < DIRECTIONS; k++)
      p->streams[p->stream_count++] = w->field[f] + k * g->size;
  for (int d = 0; d < w->body->dof; d++)
    p->streams[p->stream_count++] = w->body->displacement[d] + g->pitch;
  for (int d = 0; d < w->body->dof; d++)
    p->streams[p->stream_count++] = w->body->velocity[d] + g->pitch;
  if (!w->body->ledger) return;
  p->streams[p->stream_count++] = w->dissipated_state;
  p->streams[p->stream_count++] = w->dissipated_rate;
}

static void new_block(sweep *w, const pairwise *p, pairwise_block *b) {
  const long pitch = w->body->lattice->pitch;
  const size_t pointers = (size_t)(w->law->field_count + w->law->output_count + 1);
  row_forces *const all[] = {&b->buffer[0], &b->buffer[1], &b->seam};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++)
    *all[k] = (row_forces){.values = body_doubles(w->body, p->buffer)};
  b->pointers = body_apart(w->body, pointers * sizeof *b->pointers);
  b->parameters = body_apart(w->body, (size_t)w->law->varying_count * sizeof *b->parameters);
  b->fields = body_doubles(w->body, w->law->field_count * pitch);
  b->observed = body_doubles(w->body, (1 + w->law->output_count) * pitch);
}

static void free_own(sweep *w) {
  pairwise *p = own(w);
  free(p->blocks);
  free(p->streams);
  free(p->flags);
  free(p->some);
  free(p);
}

sweep_engine pairwise_engine(sweep *w, const double *parameters) {
  pairwise *p = must_calloc(1, sizeof *p);
  assert(w->body->dimensions == 2 && w->body->lattice->directions == DIRECTIONS);
  assert(w->law->force_planes <= PL_MAX_PLANES);
  p->stride = w->body->lattice->pitch + 2 * PL_LANES;
  p->buffer = w->law->force_planes * w->body->lattice->directions * p->stride;
  prepare_uniforms(w, p, parameters);
  compose_flags(w, p);
  p->blocks = must_calloc((size_t)w->body->block_count, sizeof *p->blocks);
  for (int k = 0; k < w->body->block_count; k++)
    new_block(w, p, &p->blocks[k]);
  if (w->body->ledger) sweep_new_losses(w);
  list_streams(w, p);
  return (sweep_engine){.step_stages = 1,
                        .force_stages = 1,
                        .observe_stages = 1,
                        .step = step,
                        .forces = observe,
                        .turn = turn,
                        .observe = observe,
                        .output = output_values,
                        .stored = stored_values,
                        .free = free_own,
                        .own = p};
}
