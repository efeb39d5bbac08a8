#include "runtime/loads/tributary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/particles/site_marks.h"
#include "runtime/particles/solid.h"

#define BESIDE 1e-3 /* spacings: so near to a line particles lie on it */

/* A straight line, and what of it lies in the bodies. */
typedef struct line {
  const rows *w;
  solid in;
  double from[3], along[3]; /* m; of length 1 */
} line;

static double along_line(const line *l, const double at[3]) {
  double sum = 0;
  for (int c = 0; c < 3; c++)
    sum += (at[c] - l->from[c]) * l->along[c];
  return sum;
}

static void place_on(const line *l, double s, double at[3]) {
  for (int c = 0; c < 3; c++)
    at[c] = l->from[c] + s * l->along[c];
}

static double beside(const line *l, const double at[3]) {
  double foot[3];
  place_on(l, along_line(l, at), foot);
  return bravais_distance(at, foot);
}

/* --- what of it lies in the bodies ------------------------------------------------------------ */

static bool lies_in(const line *l, double s) {
  const double outline = SITE_OUTLINE_TOLERANCE * l->w->spacing;
  double at[3];
  place_on(l, s, at);
  bool in = false;
  for (int n = 0; n < l->in.body_count && !in; n++)
    in = shape_contains(l->in.bodies[n], at, outline);
  for (int n = 0; n < l->in.notch_count && in; n++)
    in = !shape_contains(l->in.notches[n], at, -outline);
  return in;
}

typedef struct cut_list {
  double *at; /* parts of the way */
  int count, room;
} cut_list;

/* Also as the shape is seen from a little to either side: of a line that runs along an outline the
   ends may be missed. */
static void cut_by(const line *l, const deck_shape *shape, double from, double to, cut_list *cuts) {
  const double aside = 2 * SITE_OUTLINE_TOLERANCE * l->w->spacing;
  for (int side = -1; side <= 1; side++) {
    double a[3], b[3];
    place_on(l, from, a);
    place_on(l, to, b);
    a[0] -= side * aside * l->along[1], b[0] -= side * aside * l->along[1];
    a[1] += side * aside * l->along[0], b[1] += side * aside * l->along[0];
    const int found = shape_cuts(shape, a, b, cuts->at + cuts->count, cuts->room - cuts->count);
    if (cuts->count + found > cuts->room) { /* once more, with room for all */
      cuts->room = 2 * (cuts->count + found);
      cuts->at = must_realloc(cuts->at, (size_t)cuts->room * sizeof *cuts->at);
      side--;
      continue;
    }
    cuts->count += found;
  }
}

static int ascending(const void *p, const void *q) {
  const double a = *(const double *)p, b = *(const double *)q;
  return (a > b) - (a < b);
}

/* m of the line between two places of it. */
static double length_in(const line *l, double from, double to) {
  cut_list cuts = {.at = must_alloc(64 * sizeof *cuts.at), .room = 64};
  double sum = 0, before = 0;
  for (int n = 0; n < l->in.body_count; n++)
    cut_by(l, l->in.bodies[n], from, to, &cuts);
  for (int n = 0; n < l->in.notch_count; n++)
    cut_by(l, l->in.notches[n], from, to, &cuts);
  qsort(cuts.at, (size_t)cuts.count, sizeof *cuts.at, ascending);
  for (int k = 0; k <= cuts.count; k++) {
    const double end = k < cuts.count ? cuts.at[k] : 1;
    const double middle = from + (to - from) * (before + end) / 2;
    if (lies_in(l, middle)) sum += (to - from) * (end - before);
    before = end;
  }
  free(cuts.at);
  return sum;
}

/* --- the row ---------------------------------------------------------------------------------- */

static void place_of(const rows *w, int32_t particle, double at[3]) {
  rows_place(w, w->particle_site[particle], at);
}

static int32_t farthest_from(const rows *w, const region_sites *at, int32_t particle) {
  double from[3], here[3], most = -1;
  int32_t found = particle;
  place_of(w, particle, from);
  for (long p = 0; p < at->count; p++) {
    place_of(w, at->particles[p], here);
    const double distance = bravais_distance(from, here);
    if (distance > most * (1 + SITE_TIE_TOLERANCE)) found = at->particles[p];
    most = pl_fmax(most, distance);
  }
  return found;
}

/* False after a message: no straight line goes through the particles. */
static bool find_line(line *l, const region_sites *at, const char *region, span where,
                      diagnostics *d) {
  if (at->count < 2) {
    diag_report(d, DIAG_BAD_VALUE, where,
                "region `%s` holds one particle: a load per length acts on a row of them", region);
    diag_hint(d, "give the force as `total`, or let the region hold a row");
    return false;
  }
  const int32_t first = farthest_from(l->w, at, at->particles[0]);
  double end[3];
  place_of(l->w, first, l->from);
  place_of(l->w, farthest_from(l->w, at, first), end);
  const double length = bravais_distance(l->from, end);
  for (int c = 0; c < 3; c++)
    l->along[c] = (end[c] - l->from[c]) / length;
  for (long p = 0; p < at->count; p++) {
    double here[3];
    char text[ROWS_PLACE_TEXT];
    place_of(l->w, at->particles[p], here);
    if (beside(l, here) <= BESIDE * l->w->spacing) continue;
    diag_report(d, DIAG_BAD_VALUE, where,
                "the particles of region `%s` are no straight row: that at %s stands %.4g mm "
                "beside the line through the two that are furthest apart",
                region, rows_place_text(l->w->dimensions, here, text), 1e3 * beside(l, here));
    diag_hint(d, "let the region hold one row, or give the force as `total`");
    return false;
  }
  return true;
}

/* [count] where the particles of the line stand on it, in their order; malloc'ed. */
static double *places_of(const line *l, long *count) {
  double *places = must_alloc(((size_t)l->w->particle_count + 1) * sizeof *places);
  *count = 0;
  for (long p = 0; p < l->w->particle_count; p++) {
    double at[3];
    place_of(l->w, (int32_t)p, at);
    if (beside(l, at) <= BESIDE * l->w->spacing) places[(*count)++] = along_line(l, at);
  }
  qsort(places, (size_t)*count, sizeof *places, ascending);
  return places;
}

/* How far what is nearest to particle n of the line goes, by `side` -1 or 1; at an end as far as to
   the outline, within a spacing, where there is one. */
static double reach(const double *places, long count, long n, int side, bool outline) {
  const bool ends = n + side < 0 || n + side >= count;
  const double next = fabs(places[ends ? n - side : n + side] - places[n]);
  return ends && outline ? next : next / 2;
}

static void share_line(const line *l, const region_sites *at, double *length) {
  long count;
  double *places = places_of(l, &count);
  for (long p = 0; p < at->count; p++) {
    double here[3];
    place_of(l->w, at->particles[p], here);
    const double s = along_line(l, here);
    const double *found = bsearch(&s, places, (size_t)count, sizeof *places, ascending);
    const long n = found - places;
    const bool inside = lies_in(l, s); /* else of a body without an outline, a point or segment */
    const double from = s - reach(places, count, n, -1, inside),
                 to = s + reach(places, count, n, 1, inside);
    length[p] = inside ? length_in(l, from, to) : to - from;
  }
  free(places);
}

/* --- bars ------------------------------------------------------------------------------------- */

static double half_of_bonds(const rows *w, int32_t particle) {
  const long site = w->particle_site[particle];
  double sum = 0, chord[3];
  for (int k = 0; k < 2 * w->directions; k++)
    if (rows_has_neighbour(w, site, k)) sum += rows_chord(w, site, k, chord) / 2;
  return sum;
}

bool tributary_lengths(const deck *k, int lattice, const rows *w, const region_sites *at,
                       const char *region, span where, double *length, diagnostics *d) {
  line l = {.w = w};
  if (deck_lattice_is_bar(&k->lattices[lattice])) {
    for (long p = 0; p < at->count; p++)
      length[p] = half_of_bonds(w, at->particles[p]);
    return true;
  }
  if (!find_line(&l, at, region, where, d)) return false;
  solid_begin(&l.in, k, lattice);
  share_line(&l, at, length);
  solid_end(&l.in);
  return true;
}
