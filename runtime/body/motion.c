#include "runtime/body/motion.h"

#include <math.h>
#include <string.h>

#include "runtime/base/lane_sum.h"
#include "runtime/body/rotation_vector.h"

/* Absent sites have no weight, and nothing acts on them: they stay where they are. */
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

/* Each particle has a mass of its own. */
static int64_t add_pushes(long count, double push, double limit, const double *restrict force,
                          const double *restrict mobility, double *restrict next) {
  int64_t bad = 0;
  INDEPENDENT
  for (long q = 0; q < count; q++) {
    const double after = next[q] + push * mobility[q] * force[q];
    next[q] = after;
    bad |= __builtin_fabs(after) < limit ? INT64_C(0) : INT64_C(1);
  }
  return bad;
}

int64_t motion_push(const body *w, const row_part *at, int component, double *next) {
  const long start = body_start(w, at->row) + at->first, count = at->end - at->first;
  const double step = w->time_step * motion_force_part(w), limit = w->limit[component];
  int64_t bad = 0;
  if (component >= w->dimensions) return 0;
  next += at->first;
  if (w->weight)
    bad |= add_push(count, step * w->gravity[component], limit, w->weight + start, next);
  if (!w->row_outer || !w->row_outer[at->row]) return bad;
  const double *force = w->outer[component] + start, push = step / w->mass[component];
  return bad | (w->mobility[0] ? add_pushes(count, push, limit, force, w->mobility[0] + start, next)
                               : add_push(count, push, limit, force, next));
}

/* All components in one loop, with a literal number of them. */
static inline __attribute__((always_inline)) void drift(const body *w, int dof, const row_part *at,
                                                        const double *next) {
  const long start = body_start(w, at->row), pitch = w->lattice->pitch;
  const double step = w->time_step;
  INDEPENDENT
  for (long q = at->first; q < at->end; q++)
    for (int d = 0; d < dof; d++) {
      const double now = next[d * pitch + q];
      w->velocity[d][start + q] = now;
      w->displacement[d][start + q] += step * now;
    }
}

static void turn_part(const body *w, const row_part *at, const double *next) {
  const long start = body_start(w, at->row) + at->first, count = at->end - at->first;
  const double *rate[3];
  double *turned[3];
  for (int k = 0; k < 3; k++) {
    rate[k] = next + (3 + k) * w->lattice->pitch + at->first;
    turned[k] = w->displacement[3 + k] + start;
    memcpy(w->velocity[3 + k] + start, rate[k], (size_t)count * sizeof *rate[k]);
  }
  rotation_vector_turn_all(count, w->time_step, rate, turned);
}

void motion_turned_before(const body *w, long site, double r[3]) {
  double back[3];
  for (int k = 0; k < 3; k++) {
    r[k] = w->displacement[3 + k][site];
    back[k] = -w->time_step * w->velocity[3 + k][site];
  }
  rotation_vector_turn(r, back);
}

void motion_change(body *w, int component, long site, double change) {
  if (w->dof < 6 || component < 3) {
    w->velocity[component][site] += change;
    w->displacement[component][site] += w->time_step * change;
    return;
  }
  double r[3], turn[3];
  motion_turned_before(w, site, r);
  w->velocity[component][site] += change;
  for (int k = 0; k < 3; k++)
    turn[k] = w->time_step * w->velocity[3 + k][site];
  rotation_vector_turn(r, turn);
  for (int k = 0; k < 3; k++)
    w->displacement[3 + k][site] = r[k];
}

/* Of a part's particles, over the mean; NULL where all are alike. */
static const double *relative_mass(const body *w, int component, const row_part *at) {
  const double *relative = w->relative_mass[body_turns(w, component)];
  return relative ? relative + body_start(w, at->row) + at->first : NULL;
}

void motion_note_bad(const body *w, body_block *b, int row, long first) {
  const long start = body_start(w, row);
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

static void keep_ledger(body *w, const body_block *b, const row_part *at) {
  const long start = body_start(w, at->row) + at->first, count = at->end - at->first;
  for (int d = 0; d < w->dof; d++) {
    const double *next = b->next + d * w->lattice->pitch + at->first, *m = relative_mass(w, d, at);
    if (w->decay < 1 && w->ledger)
      w->row_mass[at->row] +=
          0.5 * w->mass[d] * motion_drag(w) * lane_square(count, m, w->velocity[d] + start, next);
    if (w->weight && d < w->dimensions)
      w->row_gravity[at->row] +=
          w->gravity_work[d] * (m ? lane_dot(count, NULL, m, next) : lane_total(count, next));
  }
}

void motion_drift(body *w, body_block *b, const row_part *at) {
  if ((w->decay < 1 && w->ledger) || w->weight) keep_ledger(w, b, at);
  if (w->dof == 2)
    drift(w, 2, at, b->next);
  else
    drift(w, 3, at, b->next);
  if (w->dof == 6) turn_part(w, at, b->next);
}

void motion_observe(body *w, const body_block *b, int row) {
  const long start = body_start(w, row);
  const long count = w->count[row];
  const row_part whole = whole_row(w, row);
  body_row *r = &w->observed[row];
  r->kinetic = r->free = r->mass = r->internal = r->state = r->rate = r->given = 0;
  for (int d = 0; d < w->dof; d++) {
    const double *v = w->velocity[d] + start, *next = b->next + d * w->lattice->pitch;
    const double *m = relative_mass(w, d, &whole);
    const double half = 0.5 * w->mass[d], square = lane_dot(count, m, v, v),
                 product = lane_dot(count, m, v, next);
    r->kinetic += half * product;
    r->mass += half * motion_drag(w) * (square + product);
    const double work = -0.5 * w->time_step * lane_dot(count, NULL, w->force[d] + start, v);
    r->internal += work;
    r->free += half * square - work;
  }
}
