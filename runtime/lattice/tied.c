#include "runtime/lattice/tied.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/lattice/near_particles.h"
#include "runtime/lattice/scattered.h"

/* How far outside of a cell a place may be by rounding, as a weight. */
#define ROUNDING 1e-9
/* Sites that may be corners of the cell: the nearest ones within so many spacings. */
enum { SPACINGS = 3, NEAREST = 14, MOST_CORNERS = ROWS_MOST_COPIED };

typedef struct tier {
  const deck_link *link;
  const rows *bar, *body;
  near_particles near;
  rows_copy *copies; /* [2 count] of the bar, then of the place */
  double *at[3];     /* [2 count] m */
  point_pair *pairs; /* [count] */
  long count, outside;
} tier;

/* --- cells ------------------------------------------------------------------------------------ */

static int by_distance(const void *a, const void *b) {
  const near_particle *p = a, *q = b;
  if (p->square != q->square) return p->square < q->square ? -1 : 1;
  return p->particle < q->particle ? -1 : p->particle > q->particle;
}

/* The nearest first; returns how many there are, at most NEAREST. */
static int find_nearest(near_particles *near, const double from[3]) {
  near_particles_find(near, from);
  if (near->count > 1) qsort(near->found, (size_t)near->count, sizeof *near->found, by_distance);
  return near->count < NEAREST ? (int)near->count : NEAREST;
}

/* Determinant of the edges from the first of the corners, one of which is replaced by the place. */
static double volume_of(int dimensions, const near_particle *const corner[MOST_CORNERS],
                        int replaced) {
  static const double here[3] = {0, 0, 0};
  const double *p[MOST_CORNERS];
  double e[3][3];
  for (int k = 0; k <= dimensions; k++)
    p[k] = k == replaced ? here : corner[k]->way;
  for (int k = 0; k < dimensions; k++)
    for (int a = 0; a < dimensions; a++)
      e[k][a] = p[k + 1][a] - p[0][a];
  if (dimensions == 2) return e[0][0] * e[1][1] - e[0][1] * e[1][0];
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
         e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

/* Weights of the corners; false: flat, or the place is outside. */
static bool weigh(int dimensions, double flat, const near_particle *const corner[MOST_CORNERS],
                  double weight[MOST_CORNERS]) {
  const double whole = volume_of(dimensions, corner, -1);
  if (!(fabs(whole) > flat)) return false;
  for (int k = 0; k <= dimensions; k++) {
    weight[k] = volume_of(dimensions, corner, k) / whole;
    if (weight[k] < -ROUNDING) return false;
  }
  return true;
}

/* Of all cells of nearest sites that hold the place, that whose corners are the nearest. */
typedef struct cell_search {
  int dimensions, count;
  double flat; /* m^2, m^3: cells that are no larger are none */
  const near_particle *nearest;
  const near_particle *corner[MOST_CORNERS];
  double least;
  rows_copy *best;
} cell_search;

static void take_cell(cell_search *s) {
  double weight[MOST_CORNERS], sum = 0;
  for (int k = 0; k <= s->dimensions; k++)
    sum += s->corner[k]->square;
  if (!(sum < s->least) || !weigh(s->dimensions, s->flat, s->corner, weight)) return;
  s->least = sum;
  s->best->count = 0;
  for (int k = 0; k <= s->dimensions; k++) {
    if (weight[k] <= ROUNDING) continue;
    s->best->particle[s->best->count] = s->corner[k]->particle;
    s->best->weight[s->best->count++] = weight[k];
  }
}

static void search_cells(cell_search *s, int corners, int from) {
  if (corners > s->dimensions || corners == MOST_CORNERS) {
    take_cell(s);
    return;
  }
  for (int n = from; n < s->count; n++) {
    s->corner[corners] = &s->nearest[n];
    search_cells(s, corners + 1, n + 1);
  }
}

/* The heaviest first. */
static void make_weights_whole(rows_copy *c) {
  double sum = 0;
  for (int k = 1; k < c->count; k++) {
    if (!(c->weight[k] > c->weight[0])) continue;
    const double weight = c->weight[0];
    const int32_t particle = c->particle[0];
    c->weight[0] = c->weight[k];
    c->particle[0] = c->particle[k];
    c->weight[k] = weight;
    c->particle[k] = particle;
  }
  for (int k = 0; k < c->count; k++)
    sum += c->weight[k];
  for (int k = 0; k < c->count; k++)
    c->weight[k] /= sum;
}

static bool find_cell(tier *t, const double from[3], rows_copy *out) {
  const double edge = t->body->spacing;
  cell_search s = {.dimensions = t->body->dimensions,
                   .count = find_nearest(&t->near, from),
                   .flat = 1e-6 * (t->body->dimensions == 2 ? edge * edge : edge * edge * edge),
                   .nearest = t->near.found,
                   .least = INFINITY,
                   .best = out};
  search_cells(&s, 0, 0);
  if (out->count == 0) return false;
  make_weights_whole(out);
  return true;
}

/* --- the bar ---------------------------------------------------------------------------------- */

static bool is_closed(const rows *bar) {
  return bar->bond_count == bar->particle_count;
}

/* Particles before and after one, from which the bar's direction there is taken. */
static void find_direction(const tier *t, int32_t particle, rows_copy *c, double tangent[3]) {
  const int32_t last = (int32_t)t->bar->particle_count - 1;
  const bool closed = is_closed(t->bar);
  c->before = particle > 0 ? particle - 1 : closed ? last : 0;
  c->after = particle < last ? particle + 1 : closed ? 0 : last;
  double from[3], to[3], length = 0;
  rows_place(t->bar, t->bar->particle_site[c->before], from);
  rows_place(t->bar, t->bar->particle_site[c->after], to);
  for (int a = 0; a < 3; a++)
    length += (to[a] - from[a]) * (to[a] - from[a]);
  for (int a = 0; a < 3; a++)
    tangent[a] = (to[a] - from[a]) / sqrt(length);
}

/* The length of bar that a bond stands for: half of the way to the next chosen ones, which at an
   end there may be none of. */
static double length_of(const tier *t, int32_t particle) {
  const double half = 0.5 * t->link->every, last = (double)t->bar->particle_count - 1;
  if (is_closed(t->bar)) return t->link->spacing;
  return (pl_fmin(particle + half, last) - pl_fmax(particle - half, 0)) / t->link->every *
         t->link->spacing;
}

static void tie(tier *t, int32_t particle) {
  rows_copy bar = {.lattice = t->link->of_bar, .count = 1, .particle = {particle}, .weight = {1}},
            place_of = {.lattice = t->link->of_around};
  double at[3], tangent[3];
  rows_place(t->bar, t->bar->particle_site[particle], at);
  if (!find_cell(t, at, &place_of)) {
    t->outside++;
    return;
  }
  find_direction(t, particle, &bar, tangent);
  place_of.at = bar.at = particle;
  place_of.before = bar.before;
  place_of.after = bar.after;
  place_of.ahead = length_of(t, particle);
  bar.along = place_of.along = true;
  const long n = 2 * t->count;
  t->copies[n] = bar;
  t->copies[n + 1] = place_of;
  for (int a = 0; a < t->body->dimensions; a++) {
    t->at[a][n] = at[a];
    t->at[a][n + 1] = at[a] + place_of.ahead * tangent[a];
  }
  t->pairs[t->count++] = (point_pair){(int32_t)n, (int32_t)n + 1};
}

/* --- all of it -------------------------------------------------------------------------------- */

static rows *rows_of(const tier *t) {
  const long count = 2 * t->count;
  double *measure = must_calloc((size_t)count + 1, sizeof *measure);
  for (long n = 0; n < count; n++)
    measure[n] = t->bar->area * t->link->spacing;
  const scattered from = {.points = {t->body->dimensions, count, {t->at[0], t->at[1], t->at[2]}},
                          .measure = measure,
                          .spacing = t->link->spacing,
                          .bonds = t->pairs,
                          .bond_count = t->count,
                          .area = t->bar->area};
  long crowded;
  rows *w = scattered_rows(&from, &crowded);
  free(measure);
  return w;
}

static bool is_tied(const tier *t, diagnostics *d) {
  const deck_link *k = t->link;
  if (t->count > 0 && t->outside > 0) {
    diag_report(
        d, DIAG_DECK_WARNING, deck_where(&k->item, "bar"),
        "%ld of the bar's particles that the link `%s` chooses lie outside of `%s`, and are "
        "not joined",
        t->outside, k->name, k->around);
    return true;
  }
  if (t->count > 0) return true;
  if (t->outside > 0) {
    diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&k->item, "bar"),
                "the link `%s` joins nothing: the bar `%s` lies outside of `%s`", k->name, k->bar,
                k->around);
    diag_hint(d, "compare the bar's `points` with the lattice's bodies and notches");
  } else {
    diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&k->item, "first"),
                "the bar `%s` has %ld particles: there is none with the number %d", k->bar,
                t->bar->particle_count, k->first);
    diag_hint(d, "they are counted from 0");
  }
  return false;
}

rows *tied_build(const deck_link *link, const rows *bar, const rows *body, diagnostics *d) {
  const size_t most = (size_t)bar->particle_count + 1;
  tier t = {.link = link,
            .bar = bar,
            .body = body,
            .near = near_particles_of(body, SPACINGS * body->spacing),
            .copies = must_calloc(2 * most, sizeof(rows_copy)),
            .pairs = must_calloc(most, sizeof(point_pair))};
  for (int a = 0; a < body->dimensions; a++)
    t.at[a] = must_calloc(2 * most, sizeof(double));
  for (long p = link->first; p < bar->particle_count; p += link->every)
    tie(&t, (int32_t)p);
  rows *w = is_tied(&t, d) ? rows_of(&t) : NULL;
  if (w)
    w->copies = t.copies;
  else
    free(t.copies);
  near_particles_end(&t.near);
  free(t.pairs);
  for (int a = 0; a < 3; a++)
    free(t.at[a]);
  return w;
}
