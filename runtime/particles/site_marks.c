#include "runtime/particles/site_marks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/geometry/shape.h"

#define FARTHEST 1e8 /* spacings from the origin: positions keep 1e-8 spacings */

enum { COLUMN, ROW, LAYER };
enum { IN_BODY = 1, IN_NOTCH = 2 };

/* --- ranges ----------------------------------------------------------------------------------- */

double site_range_count(const site_range *r) {
  double count = 1;
  for (int c = 0; c < 3; c++)
    count *= r->first[c] > r->last[c] ? 0 : (double)(r->last[c] - r->first[c]) + 1;
  return count;
}

void site_range_clip(site_range *r, const site_range *to) {
  for (int c = 0; c < 3; c++) {
    if (r->first[c] < to->first[c]) r->first[c] = to->first[c];
    if (r->last[c] > to->last[c]) r->last[c] = to->last[c];
  }
}

static void widen(site_range *all, const site_range *one) {
  for (int c = 0; c < 3; c++) {
    if (one->first[c] < all->first[c]) all->first[c] = one->first[c];
    if (one->last[c] > all->last[c]) all->last[c] = one->last[c];
  }
}

static site_range one_site(long column, long row, long layer) {
  return (site_range){{column, row, layer}, {column, row, layer}};
}

/* Corners of the shape's box, seen from the lattice. */
bool site_range_of(const bravais *b, const deck_shape *shape, site_range *out) {
  double lower[3], upper[3], least[3], most[3];
  shape_box(shape, lower, upper);
  for (int c = 0; c < 3; c++) {
    least[c] = INFINITY;
    most[c] = -INFINITY;
  }
  for (int corner = 0; corner < 1 << b->dimensions; corner++) {
    double p[3], q[3];
    for (int c = 0; c < 3; c++)
      p[c] = corner >> c & 1 ? upper[c] : lower[c];
    bravais_coordinates(b, p, q);
    for (int c = 0; c < 3; c++) {
      if (!(fabs(q[c]) < FARTHEST)) return false;
      least[c] = pl_fmin(least[c], q[c]);
      most[c] = pl_fmax(most[c], q[c]);
    }
  }
  const double margin = 2 * SITE_OUTLINE_TOLERANCE;
  least[COLUMN] -= 0.5; /* rows that are shifted by half a step */
  for (int c = 0; c < 3; c++) {
    out->first[c] = (long)ceil(least[c] - margin);
    out->last[c] = (long)floor(most[c] + margin);
  }
  return true;
}

/* The nearest site is in one of the rows around the point. */
static double nearest_site(const bravais *b, const double p[3], site_range *site) {
  const double tie = SITE_TIE_TOLERANCE * b->spacing;
  double at[3], best = INFINITY;
  bravais_coordinates(b, p, at);
  const long below = (long)floor(at[LAYER]), before = (long)floor(at[ROW]);
  for (long layer = below; layer <= below + (b->axes > 2); layer++)
    for (long row = before; row <= before + (b->axes > 1); row++) {
      const long column = lround(at[COLUMN] - 0.5 * bravais_shift(b, row, layer));
      double q[3];
      bravais_place(b, column, row, layer, q);
      const double distance = bravais_distance(p, q);
      if (distance >= best - tie) continue;
      best = distance;
      *site = one_site(column, row, layer);
    }
  return best;
}

static double point_within(const deck_shape *shape, double spacing) {
  return shape->within > 0 ? shape->within : spacing / 2;
}

double site_point_reach(const deck_shape *shape, double spacing) {
  return point_within(shape, spacing) + SITE_OUTLINE_TOLERANCE * spacing;
}

/* Sites that may lie in the shape; of a point exactly one, or none. */
static bool candidate_range(const bravais *b, const deck_shape *shape, site_range *out) {
  if (!site_range_of(b, shape, out)) return false;
  if (shape->kind != SHAPE_POINT) return true;
  if (nearest_site(b, shape->at, out) > site_point_reach(shape, b->spacing))
    out->last[ROW] = out->first[ROW] - 1;
  return true;
}

/* --- marks ------------------------------------------------------------------------------------ */

typedef struct marking {
  site_marks *marks;
  const bravais *bravais;
  const deck *deck;
  const deck_lattice *lattice;
  diagnostics *d;
} marking;

bool site_of_lattice(const deck_lattice *l, const char *name) {
  return name == NULL || strcmp(name, l->name) == 0;
}

bool site_notch_between(const deck *k, const deck_lattice *l, const double from[3],
                        const double to[3], double tolerance) {
  for (int n = 0; n < k->notch_count; n++)
    if (site_of_lattice(l, k->notchs[n].lattice) &&
        shape_crossed(&k->notchs[n].shape, from, to, tolerance))
      return true;
  return false;
}

bool site_too_many(const deck_lattice *l, double sites, diagnostics *d) {
  if (sites <= SITE_MOST) return false;
  const double part = sites / SITE_MOST;
  const double wider = deck_lattice_is_chain(l)          ? part
                       : deck_lattice_dimensions(l) == 2 ? sqrt(part)
                                                         : pl_cbrt(part);
  const bool bar = deck_lattice_is_bar(l);
  diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&l->item, "spacing"),
              bar ? "the bar '%s' has %.3g particles; the most that can be stored are %.0e"
                  : "the bodies of lattice '%s' span %.3g sites; the most that can be stored are "
                    "%.0e",
              l->name, sites, SITE_MOST);
  const char *close = bar ? "" : ", if the bodies lie close together";
  if (l->graded)
    diag_hint(d, "spacings %.3g times as large would do%s", wider * 1.01, close);
  else
    diag_hint(d, "a spacing of %.3g mm would do%s", 1e3 * l->spacing * wider * 1.01, close);
  return true;
}

static bool body_range(const marking *k, const deck_body *body, site_range *out) {
  if (candidate_range(k->bravais, &body->shape, out)) return true;
  diag_report(k->d, DIAG_OUT_OF_BOUNDS, body->item.where,
              "the body reaches farther than %.0e spacings from the origin of lattice '%s'",
              FARTHEST, k->lattice->name);
  diag_hint(k->d, "check the units of the body's lengths and of the lattice's spacing");
  return false;
}

/* The range that all bodies need; nothing has been allocated yet when it is refused. */
static bool find_span(marking *k) {
  site_range all = {{2, 2, 2}, {-2, -2, -2}};
  bool any = false;
  for (int n = 0; n < k->deck->body_count; n++) {
    const deck_body *body = &k->deck->bodys[n];
    site_range r;
    if (!site_of_lattice(k->lattice, body->lattice)) continue;
    if (!body_range(k, body, &r)) return false;
    if (site_range_count(&r) == 0) continue;
    if (any)
      widen(&all, &r);
    else
      all = r;
    any = true;
  }
  if (site_too_many(k->lattice, site_range_count(&all), k->d)) return false;
  k->marks->span = all;
  k->marks->bits = calloc((size_t)site_range_count(&all) + 1, 1);
  if (k->marks->bits != NULL) return true;
  diag_report(k->d, DIAG_OUT_OF_BOUNDS, deck_where(&k->lattice->item, "spacing"),
              "there is not enough memory for %.3g sites", site_range_count(&all));
  return false;
}

static unsigned char *mark_at(const site_marks *m, long column, long row, long layer) {
  const long *first = m->span.first, *last = m->span.last;
  const long rows = last[ROW] - first[ROW] + 1, columns = last[COLUMN] - first[COLUMN] + 1;
  return m->bits + ((layer - first[LAYER]) * rows + row - first[ROW]) * columns + column -
         first[COLUMN];
}

typedef struct mark_counts {
  long inside; /* sites of the shape that `wanted` allows */
  long fresh;  /* of these, sites that did not have the bit */
} mark_counts;

/* Sets `bit` on the sites of the shape that have all bits of `wanted`. */
static mark_counts mark_shape(marking *k, const deck_shape *shape, unsigned char wanted,
                              unsigned char bit) {
  const double tolerance = SITE_OUTLINE_TOLERANCE * k->bravais->spacing;
  mark_counts counts = {0, 0};
  site_range r;
  if (!candidate_range(k->bravais, shape, &r)) return counts;
  site_range_clip(&r, &k->marks->span);
  for (long layer = r.first[LAYER]; layer <= r.last[LAYER]; layer++)
    for (long row = r.first[ROW]; row <= r.last[ROW]; row++)
      for (long column = r.first[COLUMN]; column <= r.last[COLUMN]; column++) {
        unsigned char *mark = mark_at(k->marks, column, row, layer);
        double p[3];
        if ((*mark & wanted) != wanted) continue;
        bravais_place(k->bravais, column, row, layer, p);
        if (shape->kind != SHAPE_POINT && !shape_contains(shape, p, tolerance)) continue;
        counts.inside++;
        if (!(*mark & bit)) counts.fresh++;
        *mark = (unsigned char)(*mark | bit);
      }
  return counts;
}

static void report_no_site_near(const marking *k, const deck_body *body) {
  site_range site;
  double p[3];
  const double distance = nearest_site(k->bravais, body->shape.at, &site);
  bravais_place(k->bravais, site.first[COLUMN], site.first[ROW], site.first[LAYER], p);
  diag_report(k->d, DIAG_EMPTY_REGION, deck_where(&body->item, "at"),
              "no site of lattice '%s' lies within %.6g mm of this point", k->lattice->name,
              1e3 * point_within(&body->shape, k->bravais->spacing));
  char above[40] = "";
  if (k->bravais->dimensions > 2) snprintf(above, sizeof above, ", '%.8g mm'", 1e3 * p[2]);
  diag_hint(k->d, "the nearest site, %.6g mm away, is at '%.8g mm', '%.8g mm'%s", 1e3 * distance,
            1e3 * p[0], 1e3 * p[1], above);
}

static void report_empty_body(const marking *k, const deck_body *body) {
  if (body->shape.kind == SHAPE_POINT) {
    report_no_site_near(k, body);
    return;
  }
  diag_report(k->d, DIAG_EMPTY_REGION, body->item.where,
              "the body contains no site of lattice '%s'", k->lattice->name);
  if (k->bravais->axes == 1)
    diag_hint(k->d, "the row of a chain goes through the lattice's `origin`, `rotation` from x");
  else
    diag_hint(k->d, "its extent is less than the spacing of %.6g mm, or a length has a wrong unit",
              1e3 * k->bravais->spacing);
}

/* An extra point that is there already is meant to be conditional: no message. */
static bool mark_bodies(marking *k) {
  bool sound = true, any = false;
  for (int n = 0; n < k->deck->body_count; n++) {
    const deck_body *body = &k->deck->bodys[n];
    if (!site_of_lattice(k->lattice, body->lattice)) continue;
    any = true;
    const mark_counts counts = mark_shape(k, &body->shape, 0, IN_BODY);
    if (counts.inside == 0) {
      report_empty_body(k, body);
      sound = false;
    } else if (counts.fresh == 0 && body->shape.kind != SHAPE_POINT) {
      diag_report(k->d, DIAG_DECK_WARNING, body->item.where,
                  "the body adds nothing: other bodies cover all of its %ld sites", counts.inside);
    }
  }
  if (any) return sound;
  diag_report(k->d, DIAG_EMPTY_REGION, k->lattice->item.where, "lattice '%s' has no body",
              k->lattice->name);
  diag_hint(k->d, "add a group &body with lattice = '%s'", k->lattice->name);
  return false;
}

static void mark_notches(marking *k) {
  for (int n = 0; n < k->deck->notch_count; n++)
    if (site_of_lattice(k->lattice, k->deck->notchs[n].lattice))
      k->marks->removed[n] = mark_shape(k, &k->deck->notchs[n].shape, IN_BODY, IN_NOTCH).inside;
}

bool site_marks_stands(const site_marks *m, long column, long row, long layer) {
  return *mark_at(m, column, row, layer) == IN_BODY;
}

/* Rows, columns and layers that are left. */
static bool trim(marking *k) {
  site_marks *m = k->marks;
  bool any = false;
  for (long layer = m->span.first[LAYER]; layer <= m->span.last[LAYER]; layer++)
    for (long row = m->span.first[ROW]; row <= m->span.last[ROW]; row++)
      for (long column = m->span.first[COLUMN]; column <= m->span.last[COLUMN]; column++) {
        if (!site_marks_stands(m, column, row, layer)) continue;
        const site_range one = one_site(column, row, layer);
        if (any)
          widen(&m->left, &one);
        else
          m->left = one;
        any = true;
      }
  if (any) return true;
  diag_report(k->d, DIAG_EMPTY_REGION, k->lattice->item.where,
              "the notches remove every site of lattice '%s'", k->lattice->name);
  return false;
}

bool site_marks_make(site_marks *m, const bravais *b, const deck *k, const deck_lattice *l,
                     diagnostics *d) {
  *m = (site_marks){.removed = must_calloc((size_t)k->notch_count + 1, sizeof *m->removed)};
  marking at = {.marks = m, .bravais = b, .deck = k, .lattice = l, .d = d};
  if (!find_span(&at) || !mark_bodies(&at)) return false;
  mark_notches(&at);
  return trim(&at);
}

void site_marks_free(site_marks *m) {
  free(m->bits);
  free(m->removed);
}
