#include "runtime/interaction/stamp.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

enum { LISTED_STEPS = 8 }; /* none goes further than the smallest spacing in a step */

typedef struct stamp_side {
  stamp_body from;
  double *dragged; /* [dimensions][particles] m; NULL without friction */
} stamp_side;

typedef struct near_particle {
  int32_t side, particle, site;
} near_particle;

typedef struct touch { /* of a particle, found last */
  int32_t side, site;
  double force[3];  /* N, on it */
  double damped[3]; /* N: the part of damping */
} touch;

struct stamp {
  surface surface;
  double box[2][3]; /* m: corners of least and largest coordinates, where it is drawn */
  double friction, damping;
  stamp_side *sides; /* [count] */
  int count, dimensions;
  double *dragged; /* [drag_count] of all sides */
  size_t drag_count;
  double largest, least; /* m: spacings */
  int steps;             /* that the list still holds for */
  near_particle *near;
  long near_count, near_room;
  touch *touching;
  long touch_count, touch_room;
};

/* --- set-up ----------------------------------------------------------------------------------- */

/* Of the surface: along each coordinate axis as far as it reaches. */
static void find_box(stamp *s) {
  const surface *of = &s->surface;
  for (int c = 0; c < 3; c++) {
    double reach = of->half[0];
    if (of->kind == SURFACE_BOX) {
      reach = 0;
      for (int a = 0; a < s->dimensions; a++)
        reach += of->half[a] * fabs(of->axes[a][c]);
    } else if (of->kind == SURFACE_CYLINDER) {
      reach = of->half[0] * fabs(of->axes[0][c]) +
              of->half[1] * pl_hypot(of->axes[1][c], of->axes[2][c]);
    }
    s->box[0][c] = of->centre[c] - reach;
    s->box[1][c] = of->centre[c] + reach;
  }
}

static void share_out_drags(stamp *s) {
  for (int b = 0; b < s->count; b++)
    s->drag_count += (size_t)s->dimensions * (size_t)s->sides[b].from.of->lattice->particle_count;
  s->dragged = must_calloc(s->drag_count + 1, sizeof *s->dragged);
  double *at = s->dragged;
  for (int b = 0; b < s->count; b++) {
    s->sides[b].dragged = at;
    at += (size_t)s->dimensions * (size_t)s->sides[b].from.of->lattice->particle_count;
  }
}

stamp *stamp_new(const surface *of, const stamp_body *bodies, int count, double friction,
                 double damping) {
  stamp *s = must_calloc(1, sizeof *s);
  *s = (stamp){.surface = *of,
               .friction = friction,
               .damping = damping,
               .count = count,
               .dimensions = bodies[0].of->dimensions,
               .least = INFINITY};
  s->sides = must_calloc((size_t)count, sizeof *s->sides);
  for (int b = 0; b < count; b++) {
    s->sides[b] = (stamp_side){.from = bodies[b]};
    s->largest = pl_fmax(s->largest, rows_largest_spacing(bodies[b].of->lattice));
    s->least = pl_fmin(s->least, bodies[b].of->lattice->spacing);
  }
  find_box(s);
  if (friction > 0) share_out_drags(s);
  return s;
}

void stamp_free(stamp *s) {
  if (!s) return;
  free(s->sides);
  free(s->dragged);
  free(s->near);
  free(s->touching);
  free(s);
}

/* --- the list --------------------------------------------------------------------------------- */

static void make_room(void **items, long *room, long count, size_t each) {
  if (count <= *room) return;
  *room = 2 * count + 64;
  *items = must_realloc(*items, (size_t)*room * each);
}

/* Seen from the stamp where it is drawn. */
static inline void place_of(const stamp *s, const body *of, long site, const double shift[3],
                            double at[3]) {
  rows_place(of->lattice, site, at);
  for (int d = 0; d < s->dimensions; d++)
    at[d] += of->displacement[d][site] - shift[d];
}

static inline double radius_of(const body *of, long site) {
  return 0.5 * rows_spacing(of->lattice, site);
}

static inline double stiffness_of(const stamp_body *b, long site) {
  const rows *g = b->of->lattice;
  return b->by_size ? b->stiffness * (rows_spacing(g, site) / g->spacing) : b->stiffness;
}

static inline bool is_in_box(const stamp *s, const double at[3], double reach) {
  for (int d = 0; d < s->dimensions; d++)
    if (at[d] < s->box[0][d] - reach || at[d] > s->box[1][d] + reach) return false;
  return true;
}

static void list_near(stamp *s, const double shift[3]) {
  const double reach = 0.5 * s->largest + LISTED_STEPS * (s->largest + s->least);
  s->near_count = 0;
  for (int b = 0; b < s->count; b++) {
    const body *of = s->sides[b].from.of;
    for (long p = 0; p < of->lattice->particle_count; p++) {
      const int32_t site = of->lattice->particle_site[p];
      double at[3];
      place_of(s, of, site, shift, at);
      if (!is_in_box(s, at, reach)) continue;
      make_room((void **)&s->near, &s->near_room, s->near_count + 1, sizeof *s->near);
      s->near[s->near_count++] = (near_particle){b, (int32_t)p, site};
    }
  }
  make_room((void **)&s->touching, &s->touch_room, s->near_count, sizeof *s->touching);
  s->steps = LISTED_STEPS;
}

/* --- forces ----------------------------------------------------------------------------------- */

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A particle at the surface. */
typedef struct meeting {
  const stamp_side *side;
  long particle, site;
  double out[3];    /* normal */
  double past[3];   /* m/s: its velocity past the stamp */
  double across;    /* m/s: along the normal */
  double radius;    /* m: of the particle */
  double stiffness; /* N/m: of its spring */
} meeting;

/* The spring along the surface, when the particle has gone on for `step`; `most`: the largest force
   that it bears. Returns what friction takes. */
static double drag(const stamp *s, const meeting *m, double most, double step, double q[3]) {
  double *kept = m->side->dragged + m->particle;
  const long plane = m->side->from.of->lattice->particle_count;
  const double k = m->stiffness;
  double before[3] = {0}, taken = 0;
  for (int d = 0; d < s->dimensions; d++)
    before[d] = q[d] = kept[d * plane];
  if (step == 0) return 0;
  const double tilt = dot(before, m->out);
  for (int d = 0; d < s->dimensions; d++) {
    before[d] -= tilt * m->out[d];
    q[d] = before[d] + step * (m->past[d] - m->across * m->out[d]);
  }
  const double size = sqrt(dot(q, q)), part = k * size > most ? most / (k * size) : 1;
  for (int d = 0; d < s->dimensions; d++) {
    const double slip = (1 - part) * q[d];
    q[d] *= part;
    taken += 0.5 * k * (before[d] + q[d]) * slip;
    kept[d * plane] = q[d];
  }
  return taken;
}

static void add_load(const touch *t, const double arm[3], stamp_load *l) {
  double size = 0;
  for (int d = 0; d < 3; d++) {
    const int a = (d + 1) % 3, b = (d + 2) % 3;
    l->force[d] -= t->force[d];
    l->moment[d] -= arm[a] * t->force[b] - arm[b] * t->force[a];
    size += t->force[d] * t->force[d];
  }
  l->largest = pl_fmax(l->largest, sqrt(size));
  l->touching++;
}

/* Damping of a particle on its spring, N s/m. */
static double damper_of(const stamp *s, const meeting *m) {
  const body *of = m->side->from.of;
  return 2 * s->damping * sqrt(m->stiffness * body_mass(of, 0, m->site));
}

/* Of a particle that lies in the stamp by `depth`; `at`: where it is. */
static void push_out(stamp *s, const meeting *m, int side, double depth, const double at[3],
                     double step, stamp_load *l) {
  const double k = m->stiffness, spring = k * depth,
               damper = s->damping > 0 ? pl_fmax(-damper_of(s, m) * m->across, -spring) : 0;
  touch *t = &s->touching[s->touch_count++];
  double arm[3] = {0}, q[3] = {0};
  *t = (touch){.side = side, .site = (int32_t)m->site};
  if (s->dragged) l->slipped += drag(s, m, s->friction * (spring + damper), step, q);
  for (int d = 0; d < s->dimensions; d++) {
    t->damped[d] = damper * m->out[d];
    t->force[d] = spring * m->out[d] + t->damped[d] - k * q[d];
    arm[d] = at[d] - (m->radius - depth) * m->out[d] - s->surface.centre[d];
  }
  l->stored += 0.5 * k * (depth * depth + dot(q, q));
  add_load(t, arm, l);
  body_push(m->side->from.of, m->site, t->force);
}

/* What it was dragged is let go. */
static void let_go(const stamp *s, meeting *m, double step, stamp_load *l) {
  double q[3] = {0};
  const double *kept = m->side->dragged + m->particle;
  const long plane = m->side->from.of->lattice->particle_count;
  bool held = false;
  for (int d = 0; d < s->dimensions; d++)
    held = held || kept[d * plane] != 0;
  if (held) l->slipped += drag(s, m, 0, step, q);
}

stamp_load stamp_find(stamp *s, const stamp_motion *where, double step) {
  stamp_load l = {.touching = 0};
  if (s->steps-- <= 0) list_near(s, where->place);
  s->touch_count = 0;
  for (long n = 0; n < s->near_count; n++) {
    const near_particle *p = &s->near[n];
    const body *of = s->sides[p->side].from.of;
    meeting m = {.side = &s->sides[p->side],
                 .particle = p->particle,
                 .site = p->site,
                 .radius = radius_of(of, p->site),
                 .stiffness = stiffness_of(&s->sides[p->side].from, p->site)};
    double at[3];
    place_of(s, of, p->site, where->place, at);
    const bool near = is_in_box(s, at, m.radius);
    if (!near && !s->dragged) continue;
    const double depth = m.radius - surface_distance(&s->surface, at, m.out);
    for (int d = 0; d < s->dimensions; d++)
      m.past[d] = of->velocity[d][p->site] - where->velocity[d];
    m.across = dot(m.past, m.out);
    if (near && depth > 0)
      push_out(s, &m, p->side, depth, at, step, &l);
    else if (s->dragged)
      let_go(s, &m, step, &l);
  }
  return l;
}

double stamp_power(const stamp *s, const double velocity[3], double *power, double *damped) {
  double sum = 0;
  *damped = 0;
  for (long n = 0; n < s->touch_count; n++) {
    const touch *t = &s->touching[n];
    const body *of = s->sides[t->side].from.of;
    for (int d = 0; d < s->dimensions; d++) {
      const double v = of->velocity[d][t->site];
      power[t->side] += t->force[d] * v;
      sum += t->force[d] * (v - velocity[d]);
      *damped -= t->damped[d] * (v - velocity[d]);
    }
  }
  return sum;
}

/* --- where it is drawn ------------------------------------------------------------------------ */

stamp_inside stamp_look_inside(const stamp *s, const double shift[3], double least) {
  stamp_inside found = {.depth = -INFINITY};
  for (int b = 0; b < s->count; b++) {
    const body *of = s->sides[b].from.of;
    for (long p = 0; p < of->lattice->particle_count; p++) {
      const int32_t site = of->lattice->particle_site[p];
      double at[3], out[3];
      place_of(s, of, site, shift, at);
      const double depth = radius_of(of, site) - surface_distance(&s->surface, at, out);
      found.count += depth > least * rows_spacing(of->lattice, site);
      if (!(depth > found.depth)) continue;
      found.depth = depth;
      found.body = b;
      found.site = site;
    }
  }
  return found;
}

double *stamp_dragged_of(stamp *s, int number) {
  return s->sides[number].dragged;
}

double *stamp_dragged(stamp *s, size_t *count) {
  *count = s->drag_count;
  return s->dragged;
}

double stamp_memory(const stamp *s) {
  return (double)s->near_room * sizeof *s->near + (double)s->touch_room * sizeof *s->touching +
         (double)s->drag_count * sizeof *s->dragged;
}
