#include "runtime/lattice/bar_rows.h"

#include <stdlib.h>

#include "dsl/base/arena.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/geometry/polyline.h"
#include "runtime/geometry/shape.h"
#include "runtime/lattice/scattered.h"
#include "runtime/particles/site_marks.h"

typedef struct chain { /* particles in the order of the polyline */
  int dimensions;
  long count, bond_count;
  double *at[3];     /* [count] m */
  double *length;    /* [count] m that a particle stands for */
  point_pair *bonds; /* [bond_count] */
} chain;

static chain chain_new(int dimensions, long count, bool closed) {
  chain c = {.dimensions = dimensions, .count = count, .bond_count = closed ? count : count - 1};
  for (int a = 0; a < dimensions; a++)
    c.at[a] = must_alloc((size_t)count * sizeof(double));
  c.length = must_calloc((size_t)count, sizeof *c.length);
  c.bonds = must_alloc((size_t)count * sizeof *c.bonds);
  return c;
}

static void chain_free(chain *c) {
  for (int a = 0; a < 3; a++)
    free(c->at[a]);
  free(c->length);
  free(c->bonds);
}

/* Half of it to either end. */
static void join(chain *c, long bond, double length) {
  const long next = (bond + 1) % c->count;
  c->bonds[bond] = (point_pair){(int32_t)bond, (int32_t)next};
  c->length[bond] += length / 2;
  c->length[next] += length / 2;
}

/* Particle `first` and those up to the leg's end, which is that of the next leg. */
static void fill_leg(chain *c, const polyline *p, int leg, long first, long parts) {
  const double *from, *to;
  const double length = polyline_leg(p, leg, &from, &to);
  for (long k = 0; k < parts; k++) {
    const double part = (double)k / (double)parts;
    for (int a = 0; a < c->dimensions; a++)
      c->at[a][first + k] = from[a] + part * (to[a] - from[a]);
    join(c, first + k, length / (double)parts);
  }
}

static chain chain_along(const polyline *p, double spacing) {
  long parts = 0, first = 0;
  for (int leg = 0; leg < polyline_legs(p); leg++)
    parts += polyline_parts(p, leg, spacing);
  chain c = chain_new(p->dimensions, parts + !p->closed, p->closed);
  for (int leg = 0; leg < polyline_legs(p); leg++) {
    const long of_leg = polyline_parts(p, leg, spacing);
    fill_leg(&c, p, leg, first, of_leg);
    first += of_leg;
  }
  if (p->closed) return c;
  for (int a = 0; a < c.dimensions; a++)
    c.at[a][first] = p->at[(p->corners - 1) * p->dimensions + a];
  c.length[0] *= 2;
  c.length[first] *= 2;
  return c;
}

static rows *rows_of(const chain *c, double area) {
  double *volume = must_alloc((size_t)c->count * sizeof *volume), length = 0;
  for (long k = 0; k < c->count; k++) {
    volume[k] = area * c->length[k];
    length += c->length[k];
  }
  const scattered from = {.points = {c->dimensions, c->count, {c->at[0], c->at[1], c->at[2]}},
                          .measure = volume,
                          .spacing = length / (double)c->count,
                          .bonds = c->bonds,
                          .bond_count = c->bond_count,
                          .area = area};
  long crowded;
  rows *w = scattered_rows(&from, &crowded);
  free(volume);
  return w;
}

/* Legs are whole: a notch, or a crack drawn as one, may be what the bar is to hold together. */
static void warn_of_notches(const deck *k, const deck_bar *bar, const polyline *p, diagnostics *d) {
  for (int n = 0; n < k->notch_count; n++)
    for (int leg = 0; leg < polyline_legs(p) && k->notchs[n].cut_bonds; leg++) {
      const double *from, *to, length = polyline_leg(p, leg, &from, &to);
      if (!shape_crossed(&k->notchs[n].shape, from, to, 1e-9 * length)) continue;
      diag_report(d, DIAG_DECK_WARNING, deck_where(&bar->item, "points"),
                  "the bar `%s` crosses a notch, which does not cut it", bar->name);
      diag_note(d, k->notchs[n].item.where, "the notch");
      break;
    }
}

rows *bar_rows(const deck *k, int lattice, diagnostics *d) {
  const deck_bar *l = &k->lattices[lattice];
  const int dimensions = deck_lattice_dimensions(l);
  const polyline p = {dimensions, l->value_count / dimensions, l->points, l->closed};
  warn_of_notches(k, l, &p, d);
  if (site_too_many(l, polyline_length(&p) / l->spacing, d)) return NULL;
  chain c = chain_along(&p, l->spacing);
  rows *w = rows_of(&c, l->area);
  if (!w)
    diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&l->item, "spacing"),
                "there is not enough memory for %ld particles and their neighbours", c.count);
  chain_free(&c);
  return w;
}

static rows *rows_between(int dimensions, const double from[3], const double to[3], double spacing,
                          double area) {
  double ends[6];
  for (int a = 0; a < dimensions; a++) {
    ends[a] = from[a];
    ends[dimensions + a] = to[a];
  }
  const polyline p = {dimensions, 2, ends, false};
  chain c = chain_along(&p, spacing);
  rows *w = rows_of(&c, area);
  chain_free(&c);
  return w;
}

rows *bar_rows_between(int dimensions, const double from[3], const double to[3], double spacing) {
  return rows_between(dimensions, from, to, spacing, 1);
}

rows *bar_rows_straight(const rows *like, int particles) {
  const double from[3] = {0, 0, 0}, to[3] = {like->spacing * (particles - 1), 0, 0};
  return rows_between(like->dimensions, from, to, like->spacing, like->area);
}
