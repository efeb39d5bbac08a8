#include "runtime/rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/shape.h"

#define OUTLINE_TOLERANCE 1e-6 /* spacings: a site this near to an outline lies on it */
#define CHORD_TOLERANCE   1e-9 /* spacings: a chord must enter a notch deeper than this to be cut */
#define TIE_TOLERANCE     1e-9 /* spacings: of sites equally near to a point the first is taken */
#define MOST_SITES        2e8  /* absent ones included: site numbers and memory stay in bounds */
#define FARTHEST          1e8  /* spacings from the origin: positions keep 1e-8 spacings */

enum { LEAD = 1, HEXAGONAL_DIRECTIONS = 3, FULL_FAMILY = 6 };
enum { IN_BODY = 1, IN_NOTCH = 2 };

/* The infinite lattice. Row R lies R * height above the origin along the turned y axis; odd rows
   are shifted by half a spacing along the turned x axis. */
typedef struct frame {
  double origin[2], cosine, sine, spacing, height;
} frame;

/* Rows and columns of the infinite lattice, ends included. */
typedef struct range {
  long row[2], column[2];
} range;

/* Sites of a range, row by row, with the bits IN_BODY, IN_NOTCH. */
typedef struct marks {
  range span;
  long columns;
  unsigned char *bits;
} marks;

typedef struct builder {
  const deck *deck;
  const deck_lattice *lattice;
  frame frame;
  marks marks;
  diagnostics *d;
} builder;

static frame frame_of(const deck_lattice *l) {
  return (frame){.origin = {l->origin[0], l->origin[1]},
                 .cosine = cos(l->rotation),
                 .sine = sin(l->rotation),
                 .spacing = l->spacing,
                 .height = l->spacing * sqrt(3) / 2};
}

static double shift_of(long row) {
  return row % 2 != 0 ? 0.5 : 0.0;
}

static void site_position(const frame *f, long row, long column, double p[2]) {
  const double along = ((double)column + shift_of(row)) * f->spacing;
  const double up = (double)row * f->height;
  p[0] = f->origin[0] + f->cosine * along - f->sine * up;
  p[1] = f->origin[1] + f->sine * along + f->cosine * up;
}

/* Along the rows in spacings, across them in row heights. */
static void to_frame(const frame *f, const double p[2], double out[2]) {
  const double x = p[0] - f->origin[0], y = p[1] - f->origin[1];
  out[0] = (f->cosine * x + f->sine * y) / f->spacing;
  out[1] = (f->cosine * y - f->sine * x) / f->height;
}

/* The nearest site is in one of the two rows around the point. */
static double nearest_site(const frame *f, const double p[2], range *site) {
  double at[2], best = INFINITY;
  to_frame(f, p, at);
  for (long row = (long)floor(at[1]); row <= (long)floor(at[1]) + 1; row++) {
    const long column = lround(at[0] - shift_of(row));
    double q[2];
    site_position(f, row, column, q);
    const double distance = hypot(q[0] - p[0], q[1] - p[1]);
    if (distance >= best - TIE_TOLERANCE * f->spacing) continue;
    best = distance;
    *site = (range){{row, row}, {column, column}};
  }
  return best;
}

/* Corners of the shape's box, seen from the lattice; false when it is too far away to be numbered.
 */
static bool shape_range(const frame *f, const deck_shape *shape, range *out) {
  double lower[2], upper[2], least[2] = {INFINITY, INFINITY}, most[2] = {-INFINITY, -INFINITY};
  shape_box(shape, lower, upper);
  for (int corner = 0; corner < 4; corner++) {
    const double p[2] = {corner & 1 ? upper[0] : lower[0], corner & 2 ? upper[1] : lower[1]};
    double q[2];
    to_frame(f, p, q);
    for (int c = 0; c < 2; c++) {
      if (!(fabs(q[c]) < FARTHEST)) return false;
      least[c] = fmin(least[c], q[c]);
      most[c] = fmax(most[c], q[c]);
    }
  }
  const double margin = 2 * OUTLINE_TOLERANCE;
  out->row[0] = (long)ceil(least[1] - margin);
  out->row[1] = (long)floor(most[1] + margin);
  out->column[0] = (long)ceil(least[0] - 0.5 - margin);
  out->column[1] = (long)floor(most[0] + margin);
  return true;
}

static double point_within(const deck_shape *shape, double spacing) {
  return shape->within > 0 ? shape->within : spacing / 2;
}

static double point_reach(const deck_shape *shape, double spacing) {
  return point_within(shape, spacing) + OUTLINE_TOLERANCE * spacing;
}

/* Sites that may lie in the shape; of a point exactly one, or none. Empty ranges have row[0] >
 * row[1]. */
static bool candidate_range(const frame *f, const deck_shape *shape, range *out) {
  if (!shape_range(f, shape, out)) return false;
  if (shape->kind != SHAPE_POINT) return true;
  if (nearest_site(f, shape->at, out) > point_reach(shape, f->spacing))
    out->row[1] = out->row[0] - 1;
  return true;
}

static bool of_lattice(const builder *b, const char *name) {
  return name == NULL || strcmp(name, b->lattice->name) == 0;
}

static void widen(range *all, const range *one) {
  if (one->row[0] > one->row[1] || one->column[0] > one->column[1]) return;
  if (one->row[0] < all->row[0]) all->row[0] = one->row[0];
  if (one->row[1] > all->row[1]) all->row[1] = one->row[1];
  if (one->column[0] < all->column[0]) all->column[0] = one->column[0];
  if (one->column[1] > all->column[1]) all->column[1] = one->column[1];
}

static double range_sites(const range *r) {
  if (r->row[0] > r->row[1] || r->column[0] > r->column[1]) return 0;
  return ((double)(r->row[1] - r->row[0]) + 1) * ((double)(r->column[1] - r->column[0]) + 1);
}

static bool lattice_is_sound(const builder *b) {
  const deck_lattice *l = b->lattice;
  if (strcmp(l->kind, "hexagonal") != 0) {
    diag_report(b->d, DIAG_NOT_SUPPORTED, deck_where(&l->item, "kind"),
                "there is no lattice of kind '%s'", l->kind);
    diag_hint(b->d, "write kind = 'hexagonal'");
    return false;
  }
  if (!(l->spacing > 0) || !isfinite(l->spacing)) {
    diag_report(b->d, DIAG_BAD_VALUE, deck_where(&l->item, "spacing"),
                "the spacing of a lattice must be positive");
    return false;
  }
  return true;
}

static bool too_many(const builder *b, double sites) {
  if (sites <= MOST_SITES) return false;
  const double spacing = b->lattice->spacing;
  diag_report(b->d, DIAG_OUT_OF_BOUNDS, deck_where(&b->lattice->item, "spacing"),
              "the bodies of lattice '%s' span %.3g sites; the most that can be stored are %.0e",
              b->lattice->name, sites, MOST_SITES);
  diag_hint(b->d, "a spacing of %.3g mm would do, if the bodies lie close together",
            1e3 * spacing * sqrt(sites / MOST_SITES) * 1.01);
  return true;
}

static bool body_range(const builder *b, const deck_body *body, range *out) {
  if (candidate_range(&b->frame, &body->shape, out)) return true;
  diag_report(b->d, DIAG_OUT_OF_BOUNDS, body->item.where,
              "the body reaches farther than %.0e spacings from the origin of lattice '%s'",
              FARTHEST, b->lattice->name);
  diag_hint(b->d, "check the units of the body's lengths and of the lattice's spacing");
  return false;
}

/* The range that all bodies need; nothing has been allocated yet when it is refused. */
static bool find_span(builder *b) {
  range all = {{2, -2}, {2, -2}};
  bool any = false;
  for (int k = 0; k < b->deck->body_count; k++) {
    const deck_body *body = &b->deck->bodys[k];
    range r;
    if (!of_lattice(b, body->lattice)) continue;
    if (!body_range(b, body, &r)) return false;
    if (range_sites(&r) == 0) continue;
    if (any)
      widen(&all, &r);
    else
      all = r;
    any = true;
  }
  if (too_many(b, range_sites(&all))) return false;
  b->marks.span = all;
  b->marks.columns = any ? all.column[1] - all.column[0] + 1 : 0;
  b->marks.bits = calloc((size_t)range_sites(&all) + 1, 1);
  if (b->marks.bits != NULL) return true;
  diag_report(b->d, DIAG_OUT_OF_BOUNDS, deck_where(&b->lattice->item, "spacing"),
              "there is not enough memory for %.3g sites", range_sites(&all));
  return false;
}

static unsigned char *mark_at(const marks *m, long row, long column) {
  return m->bits + (row - m->span.row[0]) * m->columns + (column - m->span.column[0]);
}

static void clip_ends(long ends[2], const long to[2]) {
  if (ends[0] < to[0]) ends[0] = to[0];
  if (ends[1] > to[1]) ends[1] = to[1];
}

static void clip(range *r, const range *to) {
  clip_ends(r->row, to->row);
  clip_ends(r->column, to->column);
}

typedef struct mark_counts {
  long inside; /* sites of the shape that `wanted` allows */
  long fresh;  /* of these, sites that did not have the bit */
} mark_counts;

/* Sets `bit` on the sites of the shape that have all bits of `wanted`. */
static mark_counts mark_shape(builder *b, const deck_shape *shape, unsigned char wanted,
                              unsigned char bit) {
  mark_counts counts = {0, 0};
  range r;
  if (!candidate_range(&b->frame, shape, &r)) return counts;
  clip(&r, &b->marks.span);
  const double tolerance = OUTLINE_TOLERANCE * b->frame.spacing;
  for (long row = r.row[0]; row <= r.row[1]; row++) {
    for (long column = r.column[0]; column <= r.column[1]; column++) {
      unsigned char *mark = mark_at(&b->marks, row, column);
      double p[2];
      if ((*mark & wanted) != wanted) continue;
      site_position(&b->frame, row, column, p);
      if (shape->kind != SHAPE_POINT && !shape_contains(shape, p, tolerance)) continue;
      counts.inside++;
      if (!(*mark & bit)) counts.fresh++;
      *mark = (unsigned char)(*mark | bit);
    }
  }
  return counts;
}

static void report_empty_body(const builder *b, const deck_body *body) {
  if (body->shape.kind != SHAPE_POINT) {
    diag_report(b->d, DIAG_EMPTY_REGION, body->item.where,
                "the body contains no site of lattice '%s'", b->lattice->name);
    diag_hint(b->d, "its extent is less than the spacing of %.6g mm, or a length has a wrong unit",
              1e3 * b->frame.spacing);
    return;
  }
  range site;
  double p[2];
  const double distance = nearest_site(&b->frame, body->shape.at, &site);
  site_position(&b->frame, site.row[0], site.column[0], p);
  diag_report(b->d, DIAG_EMPTY_REGION, deck_where(&body->item, "at"),
              "no site of lattice '%s' lies within %.6g mm of this point", b->lattice->name,
              1e3 * point_within(&body->shape, b->frame.spacing));
  diag_hint(b->d, "the nearest site, %.6g mm away, is at '%.8g mm', '%.8g mm'", 1e3 * distance,
            1e3 * p[0], 1e3 * p[1]);
}

/* An extra point that is there already is meant to be conditional: no message. */
static bool mark_bodies(builder *b) {
  bool sound = true, any = false;
  for (int k = 0; k < b->deck->body_count; k++) {
    const deck_body *body = &b->deck->bodys[k];
    if (!of_lattice(b, body->lattice)) continue;
    any = true;
    const mark_counts counts = mark_shape(b, &body->shape, 0, IN_BODY);
    if (counts.inside == 0) {
      report_empty_body(b, body);
      sound = false;
    } else if (counts.fresh == 0 && body->shape.kind != SHAPE_POINT) {
      diag_report(b->d, DIAG_DECK_WARNING, body->item.where,
                  "the body adds nothing: other bodies cover all of its %ld sites", counts.inside);
    }
  }
  if (any) return sound;
  diag_report(b->d, DIAG_EMPTY_REGION, b->lattice->item.where, "lattice '%s' has no body",
              b->lattice->name);
  diag_hint(b->d, "add a group &body with lattice = '%s'", b->lattice->name);
  return false;
}

static bool stands(unsigned char mark) {
  return mark == IN_BODY;
}

/* Rows and columns that are left. */
static bool trim(builder *b, range *out) {
  const marks *m = &b->marks;
  bool any = false;
  for (long row = m->span.row[0]; row <= m->span.row[1]; row++) {
    for (long column = m->span.column[0]; column <= m->span.column[1]; column++) {
      if (!stands(*mark_at(m, row, column))) continue;
      const range one = {{row, row}, {column, column}};
      if (any)
        widen(out, &one);
      else
        *out = one;
      any = true;
    }
  }
  if (any) return true;
  diag_report(b->d, DIAG_EMPTY_REGION, b->lattice->item.where,
              "the notches remove every site of lattice '%s'", b->lattice->name);
  return false;
}

/* --- storage ------------------------------------------------------------------------------------
 */

static void *aligned_zeros(long count, size_t each) {
  const size_t bytes = (size_t)count * each;
  const size_t whole = (bytes + PL_ALIGNMENT - 1) / PL_ALIGNMENT * PL_ALIGNMENT;
  void *p = aligned_alloc(PL_ALIGNMENT, whole);
  return p != NULL ? memset(p, 0, whole) : NULL;
}

/* Rows a multiple of 4 KiB apart would share one cache set. */
static long pitch_for(long columns) {
  const long pitch = (columns + 2 * LEAD + PL_LANES - 1) / PL_LANES * PL_LANES;
  return pitch % 512 == 0 ? pitch + PL_LANES : pitch;
}

static void set_directions(rows *w, const frame *f, long first_row) {
  const double along[3] = {f->spacing, f->spacing / 2, -f->spacing / 2};
  const double up[3] = {0, f->height, f->height};
  w->directions = HEXAGONAL_DIRECTIONS;
  for (int k = 0; k < w->directions; k++) {
    w->chord[k][0] = f->cosine * along[k] - f->sine * up[k];
    w->chord[k][1] = f->sine * along[k] + f->cosine * up[k];
    w->length[k] = f->spacing;
  }
  for (int parity = 0; parity < 2; parity++) {
    const bool shifted = (first_row + parity) % 2 != 0;
    w->offset[parity][0] = 1;
    w->offset[parity][1] = w->pitch + (shifted ? 1 : 0);
    w->offset[parity][2] = w->pitch - (shifted ? 0 : 1);
  }
}

static rows *rows_new(const builder *b, const range *r) {
  rows *w = must_calloc(1, sizeof *w);
  const deck_lattice *l = b->lattice;
  w->row_count = (int)(r->row[1] - r->row[0] + 1);
  w->pitch = pitch_for(r->column[1] - r->column[0] + 1);
  w->size = (w->row_count + 2L) * w->pitch + PL_LANES;
  w->spacing = l->spacing;
  w->site_area = sqrt(3) / 2 * l->spacing * l->spacing;
  w->volume = w->site_area * l->mass_thickness;
  w->stiffness_thickness = l->stiffness_thickness;
  set_directions(w, &b->frame, r->row[0]);
  w->flags = aligned_zeros(w->size, sizeof *w->flags);
  w->present = aligned_zeros(w->size, 1);
  w->x = aligned_zeros(w->size, sizeof *w->x);
  w->y = aligned_zeros(w->size, sizeof *w->y);
  w->site_particle = aligned_zeros(w->size, sizeof *w->site_particle);
  if (w->flags && w->present && w->x && w->y && w->site_particle) return w;
  diag_report(b->d, DIAG_OUT_OF_BOUNDS, deck_where(&l->item, "spacing"),
              "there is not enough memory for %ld sites", w->size);
  rows_free(w);
  return NULL;
}

static void place_sites(rows *w, const builder *b, const range *r) {
  for (long site = 0; site < w->size - PL_LANES; site++) {
    const long row = r->row[0] + site / w->pitch - 1;
    const long column = r->column[0] + site % w->pitch - LEAD;
    double p[2];
    site_position(&b->frame, row, column, p);
    w->x[site] = p[0];
    w->y[site] = p[1];
    if (row < r->row[0] || row > r->row[1] || column < r->column[0] || column > r->column[1])
      continue;
    w->present[site] = stands(*mark_at(&b->marks, row, column));
    w->particle_count += w->present[site];
  }
}

static void number_particles(rows *w) {
  double lower[2] = {INFINITY, INFINITY}, upper[2] = {-INFINITY, -INFINITY};
  int32_t next = 0;
  w->particle_site = must_alloc((size_t)w->particle_count * sizeof *w->particle_site);
  for (long site = 0; site < w->size; site++) {
    w->site_particle[site] = w->present[site] ? next : -1;
    if (!w->present[site]) continue;
    w->particle_site[next++] = (int32_t)site;
    lower[0] = fmin(lower[0], w->x[site]);
    lower[1] = fmin(lower[1], w->y[site]);
    upper[0] = fmax(upper[0], w->x[site]);
    upper[1] = fmax(upper[1], w->y[site]);
  }
  w->width = upper[0] - lower[0];
  w->height = upper[1] - lower[1];
}

static long partner(const rows *w, long site, int direction) {
  return site + w->offset[(site / w->pitch - 1) & 1][direction];
}

static void join_neighbours(rows *w) {
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    for (int k = 0; k < w->directions; k++)
      if (w->present[partner(w, site, k)]) w->flags[site] |= PL_PRESENT(k);
  }
}

static void count_bonds(rows *w) {
  w->bond_count = 0;
  for (long p = 0; p < w->particle_count; p++)
    for (int k = 0; k < w->directions; k++)
      w->bond_count += (w->flags[w->particle_site[p]] & PL_PRESENT(k)) != 0;
}

/* --- notches ------------------------------------------------------------------------------------
 */

static bool chord_cut(const rows *w, long site, int k, const deck_shape *shape) {
  const long other = partner(w, site, k);
  const double a[2] = {w->x[site], w->y[site]}, c[2] = {w->x[other], w->y[other]};
  return shape_crossed(shape, a, c, CHORD_TOLERANCE * w->spacing);
}

/* Bonds whose chord crosses the notch, whether an earlier notch has cut them or not. */
static long cut_bonds(rows *w, const builder *b, const range *r, const deck_shape *shape) {
  range near;
  long count = 0;
  if (!shape_range(&b->frame, shape, &near)) return 0;
  /* owners lie in the row below or one site beside */
  near.row[0] -= 1;
  near.column[0] -= 1;
  near.column[1] += 1;
  clip(&near, r);
  for (long row = near.row[0]; row <= near.row[1]; row++) {
    for (long column = near.column[0]; column <= near.column[1]; column++) {
      const long site = (row - r->row[0] + 1) * w->pitch + column - r->column[0] + LEAD;
      for (int k = 0; k < w->directions && w->present[site]; k++) {
        if (!w->present[partner(w, site, k)] || !chord_cut(w, site, k, shape)) continue;
        w->flags[site] &= ~PL_PRESENT(k);
        count++;
      }
    }
  }
  return count;
}

/* removed[k]: sites that notch k takes from the bodies */
static void mark_notches(builder *b, long *removed) {
  for (int k = 0; k < b->deck->notch_count; k++)
    if (of_lattice(b, b->deck->notchs[k].lattice))
      removed[k] = mark_shape(b, &b->deck->notchs[k].shape, IN_BODY, IN_NOTCH).inside;
}

static void cut_notches(rows *w, const builder *b, const range *r, const long *removed) {
  for (int k = 0; k < b->deck->notch_count; k++) {
    const deck_notch *notch = &b->deck->notchs[k];
    if (!of_lattice(b, notch->lattice)) continue;
    const long cut = notch->cut_bonds ? cut_bonds(w, b, r, &notch->shape) : 0;
    if (removed[k] + cut > 0) continue;
    diag_report(b->d, DIAG_DECK_WARNING, notch->item.where,
                "the notch removes no particle%s of lattice '%s'",
                notch->cut_bonds ? " and cuts no bond" : "", b->lattice->name);
  }
}

/* Points may stand alone; another body without a bond is a slip. */
static bool has_bonds(const rows *w, const builder *b) {
  bool extended = false;
  for (int k = 0; k < b->deck->body_count; k++)
    extended = extended || (of_lattice(b, b->deck->bodys[k].lattice) &&
                            b->deck->bodys[k].shape.kind != SHAPE_POINT);
  if (!extended) return true;
  for (long p = 0; p < w->particle_count; p++)
    if (w->flags[w->particle_site[p]]) return true;
  diag_report(
      b->d, DIAG_OUT_OF_BOUNDS, deck_where(&b->lattice->item, "spacing"),
      "no two particles of lattice '%s' are neighbours: its spacing of %.6g mm is too large "
      "for its bodies",
      b->lattice->name, 1e3 * w->spacing);
  diag_hint(b->d, "a number without a unit is in m; millimetres are written '6.35 mm'");
  return false;
}

static rows *build(builder *b, long *removed) {
  range r = {{0, 0}, {0, 0}};
  if (!mark_bodies(b)) return NULL;
  mark_notches(b, removed);
  if (!trim(b, &r)) return NULL;
  rows *w = rows_new(b, &r);
  if (w == NULL) return NULL;
  place_sites(w, b, &r);
  number_particles(w);
  join_neighbours(w);
  if (!has_bonds(w, b)) {
    rows_free(w);
    return NULL;
  }
  cut_notches(w, b, &r, removed);
  count_bonds(w);
  return w;
}

rows *rows_build(const deck *k, int lattice, diagnostics *d) {
  builder b = {.deck = k, .lattice = &k->lattices[lattice], .d = d};
  if (!lattice_is_sound(&b)) return NULL;
  b.frame = frame_of(b.lattice);
  rows *w = NULL;
  if (find_span(&b)) {
    long *removed = must_calloc((size_t)k->notch_count + 1, sizeof *removed);
    w = build(&b, removed);
    free(removed);
  }
  free(b.marks.bits);
  return w;
}

void rows_free(rows *w) {
  if (w == NULL) return;
  free(w->flags);
  free(w->present);
  free(w->x);
  free(w->y);
  free(w->particle_site);
  free(w->site_particle);
  free(w);
}

pl_bond_class rows_bond_class(const rows *w, int direction) {
  return (pl_bond_class){.s = w->length[direction],
                         .spacing = w->spacing,
                         .t = w->stiffness_thickness,
                         .V = w->volume,
                         .mass_i = w->mass,
                         .mass_j = w->mass,
                         .shell = 1,
                         .n = FULL_FAMILY,
                         .chord = {w->chord[direction][0], w->chord[direction][1], 0}};
}

/* --- regions ------------------------------------------------------------------------------------
 */

static long select_nearest(const rows *w, const deck_shape *shape, int32_t *list) {
  double best = INFINITY;
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    const double distance = hypot(w->x[site] - shape->at[0], w->y[site] - shape->at[1]);
    if (distance >= best - TIE_TOLERANCE * w->spacing) continue;
    best = distance;
    list[0] = (int32_t)p;
  }
  return best <= point_reach(shape, w->spacing) ? 1 : 0;
}

long rows_select(const rows *w, const deck_shape *shape, int32_t **list) {
  int32_t *chosen = must_alloc((size_t)w->particle_count * sizeof *chosen);
  long count = 0;
  *list = chosen;
  if (shape->kind == SHAPE_POINT) return select_nearest(w, shape, chosen);
  for (long p = 0; p < w->particle_count; p++) {
    const double at[2] = {w->x[w->particle_site[p]], w->y[w->particle_site[p]]};
    if (shape_contains(shape, at, OUTLINE_TOLERANCE * w->spacing)) chosen[count++] = (int32_t)p;
  }
  return count;
}

void rows_bodies(const rows *w, const deck *k, int lattice, int32_t *body) {
  memset(body, 0, (size_t)w->particle_count * sizeof *body);
  for (int b = k->body_count - 1; b >= 0; b--) { /* the first has the last word */
    if (strcmp(k->bodys[b].lattice, k->lattices[lattice].name) != 0) continue;
    int32_t *list;
    const long count = rows_select(w, &k->bodys[b].shape, &list);
    for (long p = 0; p < count; p++)
      body[list[p]] = b;
    free(list);
  }
}

/* Columns of storage row `row` within `reach` (m) of the site: +1 at the first, -1 behind the last.
 */
static void add_interval(const rows *w, long site, long row, double reach, int32_t *steps) {
  const double height = w->spacing * sqrt(3) / 2;
  const long own_row = site / w->pitch, rise = row - own_row;
  const double up = (double)rise * height;
  if (fabs(up) > reach) return;
  const double half = sqrt(reach * reach - up * up) / w->spacing;
  /* a row of the other parity is shifted by half a spacing: to the right when this one is not
   * shifted */
  const bool shifted = w->offset[(own_row - 1) & 1][1] != w->pitch;
  const double shift = rise % 2 == 0 ? 0 : shifted ? -0.5 : 0.5;
  const double middle = (double)(site % w->pitch) - shift;
  const double first = fmax(ceil(middle - half), 0);
  const double last = fmin(floor(middle + half), (double)w->pitch - 1);
  if (first > last) return;
  steps[row * w->pitch + (long)first]++;
  steps[row * w->pitch + (long)last + 1]--;
}

/* Sites within `reach` of the particles; intervals a row, so that a wide reach costs rows and not
 * areas. */
static unsigned char *mark_near(const rows *w, const int32_t *particles, long count, double reach) {
  int32_t *steps = must_calloc((size_t)w->size + 1, sizeof *steps);
  unsigned char *near = must_calloc((size_t)w->size, 1);
  const double rise = fmin(ceil(reach / (w->spacing * sqrt(3) / 2)), (double)w->row_count + 1);
  for (long p = 0; p < count; p++) {
    const long site = w->particle_site[particles[p]], own = site / w->pitch;
    for (long row = own - (long)rise; row <= own + (long)rise; row++)
      if (row >= 1 && row <= w->row_count) add_interval(w, site, row, reach, steps);
  }
  int32_t depth = 0;
  for (long site = 0; site < w->size; site++) {
    depth += steps[site];
    near[site] = depth > 0;
  }
  free(steps);
  return near;
}

void rows_protect(rows *w, const int32_t *particles, long count, double radius) {
  const double reach = fmax(radius, 0) + OUTLINE_TOLERANCE * w->spacing;
  unsigned char *near = mark_near(w, particles, count, reach);
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    for (int k = 0; k < w->directions; k++) {
      if (!(w->flags[site] & PL_PRESENT(k))) continue;
      if (near[site] || near[partner(w, site, k)]) w->flags[site] |= PL_PROTECTED(k);
    }
  }
  free(near);
}

rows_bond *rows_bonds(const rows *w) {
  rows_bond *bonds = must_alloc(((size_t)w->bond_count + 1) * sizeof *bonds);
  long next = 0;
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    for (int k = 0; k < w->directions; k++) {
      if (!(w->flags[site] & PL_PRESENT(k))) continue;
      bonds[next++] = (rows_bond){.i = (int32_t)p,
                                  .j = w->site_particle[partner(w, site, k)],
                                  .slot = (int64_t)k * w->size + site};
    }
  }
  return bonds;
}
