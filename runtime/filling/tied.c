#include "runtime/filling/tied.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "runtime/lattice/scattered.h"
#include "runtime/particles/site_marks.h"

/* How far outside of a cell a place may be by rounding, as a weight. */
#define ROUNDING 1e-9
/* A line of a cell that is no deeper in a notch is not cut, in spacings. */
#define NOTCH_DEPTH 1e-6
/* Sites that may be corners of the cell: the nearest ones within so many of the largest spacings.
 */
enum { SPACINGS = 3, NEAREST = 14, MOST_CORNERS = ROWS_MOST_COPIED };

typedef struct tier {
  const deck *deck;
  const deck_link *link;
  const bar_line *line;
  const rows *bar, *body;
  near_particles near;
  rows_copy *copies; /* [2 count] of the bar, then of the place */
  double *at[3];     /* [2 count] m */
  point_pair *pairs; /* [count] */
  long count;
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

/* Of all cells of nearest sites that hold the place and that no notch goes through, that whose
   corners are the nearest. */
typedef struct cell_search {
  const rows *body;
  const deck *deck; /* whose notches cut; NULL: none do */
  const deck_lattice *around;
  const double *place;
  int dimensions, count;
  double flat; /* m^2, m^3: cells that are no larger are none */
  const near_particle *nearest;
  const near_particle *corner[MOST_CORNERS];
  double least;
  rows_copy *best;
} cell_search;

static bool is_cut(const cell_search *s, const double from[3], const double to[3]) {
  return s->deck &&
         site_notch_between(s->deck, s->around, from, to, NOTCH_DEPTH * s->body->spacing);
}

/* Between corners that carry something, or between one of them and the place. */
static bool is_cell_cut(const cell_search *s, const double weight[MOST_CORNERS]) {
  double at[MOST_CORNERS][3];
  for (int k = 0; k <= s->dimensions; k++) {
    rows_place(s->body, s->body->particle_site[s->corner[k]->particle], at[k]);
    if (weight[k] <= ROUNDING) continue;
    if (is_cut(s, s->place, at[k])) return true;
    for (int j = 0; j < k; j++)
      if (weight[j] > ROUNDING && is_cut(s, at[j], at[k])) return true;
  }
  return false;
}

static void take_cell(cell_search *s) {
  double weight[MOST_CORNERS], sum = 0;
  for (int k = 0; k <= s->dimensions; k++)
    sum += s->corner[k]->square;
  if (!(sum < s->least) || !weigh(s->dimensions, s->flat, s->corner, weight)) return;
  if (is_cell_cut(s, weight)) return;
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

near_particles tied_near(const rows *body) {
  return near_particles_of(body, SPACINGS * rows_largest_spacing(body));
}

bool tied_cell(near_particles *near, const deck *k, const deck_lattice *around,
               const double place_of[3], rows_copy *out) {
  const rows *g = near->body;
  const double edge = g->spacing;
  cell_search s = {.body = g,
                   .deck = k,
                   .around = around,
                   .place = place_of,
                   .dimensions = g->dimensions,
                   .count = find_nearest(near, place_of),
                   .flat = 1e-6 * (g->dimensions == 2 ? edge * edge : edge * edge * edge),
                   .nearest = near->found,
                   .least = INFINITY,
                   .best = out};
  out->count = 0;
  search_cells(&s, 0, 0);
  if (out->count == 0) return false;
  make_weights_whole(out);
  return true;
}

/* --- the bar ---------------------------------------------------------------------------------- */

/* Of the bar, from the particle before to that after. */
static void find_direction(const tier *t, const rows_copy *c, double tangent[3]) {
  double from[3], to[3], length = 0;
  rows_place(t->bar, t->bar->particle_site[c->before], from);
  rows_place(t->bar, t->bar->particle_site[c->after], to);
  for (int a = 0; a < 3; a++)
    length += (to[a] - from[a]) * (to[a] - from[a]);
  for (int a = 0; a < 3; a++)
    tangent[a] = (to[a] - from[a]) / sqrt(length);
}

static void tie(tier *t, int32_t particle) {
  rows_copy bar = {.lattice = t->link->of_bar, .count = 1, .particle = {particle}, .weight = {1}},
            place_of = {.lattice = t->link->of_around};
  double at[3], tangent[3];
  rows_place(t->bar, t->bar->particle_site[particle], at);
  if (!tied_cell(&t->near, t->deck, &t->deck->lattices[t->link->of_around], at, &place_of)) return;
  place_of.at = bar.at = particle;
  place_of.before = bar.before = bar_line_beside(t->line, particle, -1);
  place_of.after = bar.after = bar_line_beside(t->line, particle, 1);
  place_of.ahead = bar_line_share(t->line, particle);
  find_direction(t, &bar, tangent);
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
  if (t->count > 0) return true;
  diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&k->item, "bar"),
              "the link `%s` joins nothing: the bar `%s` lies outside of `%s`", k->name, k->bar,
              k->around);
  diag_hint(d, "compare the bar's `points` with the lattice's bodies and notches");
  return false;
}

rows *tied_build(const deck *k, const deck_link *link, const bar_line *line, const rows *bar,
                 const rows *body, diagnostics *d) {
  const size_t most = (size_t)bar->particle_count + 1;
  tier t = {.deck = k,
            .link = link,
            .line = line,
            .bar = bar,
            .body = body,
            .near = tied_near(body),
            .copies = must_calloc(2 * most, sizeof(rows_copy)),
            .pairs = must_calloc(most, sizeof(point_pair))};
  for (int a = 0; a < body->dimensions; a++)
    t.at[a] = must_calloc(2 * most, sizeof(double));
  for (int32_t p = 0; p < bar->particle_count; p++)
    if (bar_line_chooses(line, p)) tie(&t, p);
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
