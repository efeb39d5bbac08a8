#include "runtime/body/motion.h"

#include <math.h>

#include "dsl/base/elementary.h"
#include "runtime/base/lane_sum.h"

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

int64_t motion_push(const body *w, row_part at, int component, double *next) {
  if (!w->weight || component >= w->dimensions) return 0;
  const double push = w->time_step * motion_force_part(w) * w->gravity[component];
  return add_push(at.end - at.first, push, w->limit[component],
                  w->weight + body_start(w, at.row) + at.first, next + at.first);
}

/* All components in one loop, with a literal number of them. */
static inline __attribute__((always_inline)) void drift(const body *w, int dof, row_part at,
                                                        const double *next) {
  const long start = body_start(w, at.row), pitch = w->lattice->pitch;
  const double step = w->time_step;
  INDEPENDENT
  for (long q = at.first; q < at.end; q++)
    for (int d = 0; d < dof; d++) {
      const double now = next[d * pitch + q];
      w->velocity[d][start + q] = now;
      w->displacement[d][start + q] += step * now;
    }
}

/* Of a rotation vector r half the angle's cosine, and its sine over the angle: the unit quaternion
   is (*cosine, sine r). */
static inline __attribute__((always_inline)) double half_sine(const double r[3], double *cosine) {
  const double length = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
  const double angle = pl_fmax(length, 1e-150), sine = pl_sin(0.5 * angle);
  *cosine = pl_cos(0.5 * angle);
  return sine / angle;
}

/* The rotation vector r, then a turn by a: the product of their quaternions. Of all vectors of one
   rotation, which are whole turns apart, that nearest to r + a, so that turns about one axis add
   up. */
static inline __attribute__((always_inline)) void turn(double r[3], const double a[3]) {
  double here, by;
  const double s = half_sine(r, &here), t = half_sine(a, &by), both = s * t;
  double v[3];
  for (int k = 0; k < 3; k++) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    v[k] = by * s * r[k] + here * t * a[k] + both * (a[l] * r[m] - a[m] * r[l]);
  }
  const double cosine = here * by - both * (r[0] * a[0] + r[1] * a[1] + r[2] * a[2]);
  const double sine = pl_fmax(sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]), 1e-150);
  const double angle = 2 * pl_atan2(sine, cosine);
  const double along = (v[0] * (r[0] + a[0]) + v[1] * (r[1] + a[1]) + v[2] * (r[2] + a[2])) / sine;
  const double turns = (along - angle) / (2 * M_PI) + PL_ROUNDER - PL_ROUNDER;
  const double scale = (angle + turns * (2 * M_PI)) / sine;
  for (int k = 0; k < 3; k++)
    r[k] = scale * v[k];
}

static void turn_row(const body *w, row_part at, const double *next) {
  const long start = body_start(w, at.row), pitch = w->lattice->pitch;
  const double step = w->time_step;
  INDEPENDENT
  for (long q = at.first; q < at.end; q++) {
    double r[3], a[3];
    for (int k = 0; k < 3; k++) {
      const double now = next[(3 + k) * pitch + q];
      w->velocity[3 + k][start + q] = now;
      r[k] = w->displacement[3 + k][start + q];
      a[k] = step * now;
    }
    turn(r, a);
    for (int k = 0; k < 3; k++)
      w->displacement[3 + k][start + q] = r[k];
  }
}

void motion_shift(body *w, int component, long site, double way) {
  if (w->dof < 6 || component < 3) {
    w->displacement[component][site] += way;
    return;
  }
  double r[3], a[3] = {0, 0, 0};
  a[component - 3] = way;
  for (int k = 0; k < 3; k++)
    r[k] = w->displacement[3 + k][site];
  turn(r, a);
  for (int k = 0; k < 3; k++)
    w->displacement[3 + k][site] = r[k];
}

/* Of a part's particles, over the mean; NULL where all are alike. */
static const double *relative_mass(const body *w, int component, row_part at) {
  const double *relative = w->relative_mass[body_turns(w, component)];
  return relative ? relative + body_start(w, at.row) + at.first : NULL;
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

static void keep_ledger(body *w, const body_block *b, row_part at) {
  const long start = body_start(w, at.row) + at.first, count = at.end - at.first;
  for (int d = 0; d < w->dof; d++) {
    const double *next = b->next + d * w->lattice->pitch + at.first, *m = relative_mass(w, d, at);
    if (w->decay < 1 && w->ledger)
      w->row_mass[at.row] +=
          0.5 * w->mass[d] * motion_drag(w) * lane_square(count, m, w->velocity[d] + start, next);
    if (w->weight && d < w->dimensions)
      w->row_gravity[at.row] +=
          w->gravity_work[d] * (m ? lane_dot(count, NULL, m, next) : lane_total(count, next));
  }
}

void motion_drift(body *w, body_block *b, row_part at) {
  if ((w->decay < 1 && w->ledger) || w->weight) keep_ledger(w, b, at);
  if (w->dof == 2)
    drift(w, 2, at, b->next);
  else
    drift(w, 3, at, b->next);
  if (w->dof == 6) turn_row(w, at, b->next);
}

void motion_observe(body *w, const body_block *b, int row) {
  const long start = body_start(w, row);
  const long count = w->count[row];
  body_row *r = &w->observed[row];
  r->kinetic = r->free = r->mass = r->internal = r->state = r->rate = 0;
  for (int d = 0; d < w->dof; d++) {
    const double *v = w->velocity[d] + start, *next = b->next + d * w->lattice->pitch;
    const double *m = relative_mass(w, d, whole_row(w, row));
    const double half = 0.5 * w->mass[d], square = lane_dot(count, m, v, v),
                 product = lane_dot(count, m, v, next);
    r->kinetic += half * product;
    r->mass += half * motion_drag(w) * (square + product);
    const double work = -0.5 * w->time_step * lane_dot(count, NULL, w->force[d] + start, v);
    r->internal += work;
    r->free += half * square - work;
  }
}
