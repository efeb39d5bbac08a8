#include "runtime/filling/bar_rows.h"

#include <stdlib.h>

#include "dsl/base/arena.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/geometry/polyline.h"
#include "runtime/geometry/shape.h"
#include "runtime/lattice/scattered.h"
#include "runtime/particles/site_marks.h"

typedef struct chain { /* particles in the order of the polyline, copy after copy */
  int dimensions, copies;
  bool closed;
  long each, count, bond_count; /* particles of a copy, of all */
  double *at[3];                /* [count] m */
  double *length;               /* [count] m that a particle stands for */
  point_pair *bonds;            /* [bond_count] */
} chain;

static chain chain_new(const polyline *p, double spacing, int copies) {
  chain c = {.dimensions = p->dimensions, .copies = copies, .closed = p->closed};
  c.each = !p->closed;
  for (int leg = 0; leg < polyline_legs(p); leg++)
    c.each += polyline_parts(p, leg, spacing);
  c.count = copies * c.each;
  c.bond_count = c.count - !p->closed * copies;
  for (int a = 0; a < c.dimensions; a++)
    c.at[a] = must_alloc((size_t)c.count * sizeof(double));
  c.length = must_calloc((size_t)c.count, sizeof *c.length);
  c.bonds = must_alloc((size_t)c.count * sizeof *c.bonds);
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
  const long next = (bond + 1) % c->each;
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

/* The first of the copies. */
static void fill(chain *c, const polyline *p, double spacing) {
  long first = 0;
  for (int leg = 0; leg < polyline_legs(p); leg++) {
    const long of_leg = polyline_parts(p, leg, spacing);
    fill_leg(c, p, leg, first, of_leg);
    first += of_leg;
  }
  if (p->closed) return;
  for (int a = 0; a < c->dimensions; a++)
    c->at[a][first] = p->at[(p->corners - 1) * p->dimensions + a];
  c->length[0] *= 2;
  c->length[first] *= 2;
}

/* From the first, which is whole. */
static void repeat(chain *c, const double shift[3]) {
  const long bonds = c->each - !c->closed;
  for (int copy = 1; copy < c->copies; copy++) {
    const long first = copy * c->each;
    for (long k = 0; k < c->each; k++) {
      for (int a = 0; a < c->dimensions; a++)
        c->at[a][first + k] = c->at[a][k] + copy * shift[a];
      c->length[first + k] = c->length[k];
    }
    for (long k = 0; k < bonds; k++)
      c->bonds[copy * bonds + k] =
          (point_pair){(int32_t)(first + c->bonds[k].i), (int32_t)(first + c->bonds[k].j)};
  }
}

static chain chain_along(const polyline *p, double spacing, int copies, const double shift[3]) {
  chain c = chain_new(p, spacing, copies);
  fill(&c, p, spacing);
  repeat(&c, shift);
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

static bool is_crossed(const deck_bar *bar, const polyline *p, const deck_shape *notch) {
  for (int copy = 0; copy < bar->copies; copy++)
    for (int leg = 0; leg < polyline_legs(p); leg++) {
      const double *from, *to, length = polyline_leg(p, leg, &from, &to);
      double a[3], b[3];
      for (int k = 0; k < p->dimensions; k++) {
        a[k] = from[k] + copy * bar->shift[k];
        b[k] = to[k] + copy * bar->shift[k];
      }
      if (shape_crossed(notch, a, b, 1e-9 * length)) return true;
    }
  return false;
}

/* Legs are whole: a notch, or a crack drawn as one, may be what the bar is to hold together. */
static void warn_of_notches(const deck *k, const deck_bar *bar, const polyline *p, diagnostics *d) {
  for (int n = 0; n < k->notch_count; n++) {
    if (!k->notchs[n].cut_bonds || !is_crossed(bar, p, &k->notchs[n].shape)) continue;
    diag_report(d, DIAG_DECK_WARNING, deck_where(&bar->item, "points"),
                "the bar `%s` crosses a notch, which does not cut it", bar->name);
    diag_note(d, k->notchs[n].item.where, "the notch");
  }
}

rows *bar_rows(const deck *k, int lattice, diagnostics *d) {
  const deck_bar *l = &k->lattices[lattice];
  const int dimensions = deck_lattice_dimensions(l);
  const polyline p = {dimensions, l->value_count / dimensions, l->points, l->closed};
  if (site_too_many(l, l->copies * polyline_length(&p) / l->spacing, d)) return NULL;
  warn_of_notches(k, l, &p, d);
  chain c = chain_along(&p, l->spacing, l->copies, l->shift);
  rows *w = rows_of(&c, l->area);
  if (!w)
    diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&l->item, "spacing"),
                "there is not enough memory for %ld particles and their neighbours", c.count);
  chain_free(&c);
  return w;
}

rows *bar_rows_straight(const rows *like, int particles) {
  const double ends[6] = {[3] = like->spacing * (particles - 1)}, flat[4] = {[2] = ends[3]};
  const polyline p = {like->dimensions, 2, like->dimensions == 3 ? ends : flat, false};
  chain c = chain_along(&p, like->spacing, 1, NULL);
  rows *w = rows_of(&c, like->area);
  chain_free(&c);
  return w;
}
