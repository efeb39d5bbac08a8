#include "runtime/lattice/notch_depth.h"

#include <math.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "runtime/geometry/shape.h"

/* --- the notch's own box ---------------------------------------------------------------------- */

enum { NORMAL, DEPTH, WIDTH, AXES }; /* of a notch: across its plane; along it; through the body */

typedef struct box {
  double centre[3], axis[AXES][3], half[AXES];
} box;

static double along(const box *b, int axis, const double at[3]) {
  double sum = 0;
  for (int c = 0; c < 3; c++)
    sum += b->axis[axis][c] * (at[c] - b->centre[c]);
  return sum;
}

static void turn_in_plane(box *b, double cosine, double sine) {
  const double x[3] = {cosine, sine, 0}, y[3] = {-sine, cosine, 0};
  memcpy(b->axis[0], x, sizeof x);
  memcpy(b->axis[1], y, sizeof y);
}

static void take_segment(const deck_shape *s, box *b) {
  const double way[2] = {s->to[0] - s->from[0], s->to[1] - s->from[1]},
               length = pl_hypot(way[0], way[1]);
  turn_in_plane(b, way[0] / length, way[1] / length);
  for (int c = 0; c < 2; c++)
    b->centre[c] = 0.5 * (s->from[c] + s->to[c]);
  b->half[0] = 0.5 * length;
  b->half[1] = 0;
}

static void take_rectangle(const deck_shape *s, box *b) {
  turn_in_plane(b, pl_cos(s->rotation), pl_sin(s->rotation));
  for (int c = 0; c < 2; c++) {
    b->half[c] = 0.5 * s->size[c];
    b->centre[c] = s->corner[c];
  }
  for (int k = 0; k < 2; k++)
    for (int c = 0; c < 2; c++)
      b->centre[c] += b->half[k] * b->axis[k][c];
}

static void normal_of(const deck_shape *face, double normal[3]) {
  double size = 0;
  memset(normal, 0, 3 * sizeof *normal);
  for (int k = 0; k < face->point_count; k++) { /* Newell */
    const double *p = face->points + 3 * k, *q = face->points + 3 * ((k + 1) % face->point_count);
    for (int c = 0; c < 3; c++)
      normal[c] += p[(c + 1) % 3] * q[(c + 2) % 3] - p[(c + 2) % 3] * q[(c + 1) % 3];
  }
  for (int c = 0; c < 3; c++)
    size += normal[c] * normal[c];
  for (int c = 0; c < 3; c++)
    normal[c] /= sqrt(size);
}

/* One of the coordinates' axes as it lies in the plane across axis 2, and one across both. */
static void take_axes(box *b) {
  const double *n = b->axis[2];
  int thin = 0;
  for (int c = 1; c < 3; c++)
    if (fabs(n[c]) > fabs(n[thin])) thin = c;
  const int first = (thin + 1) % 3;
  double *u = b->axis[0], *v = b->axis[1];
  const double length = sqrt(1 - n[first] * n[first]);
  for (int c = 0; c < 3; c++)
    u[c] = ((c == first) - n[first] * n[c]) / length;
  for (int c = 0; c < 3; c++)
    v[c] = n[(c + 1) % 3] * u[(c + 2) % 3] - n[(c + 2) % 3] * u[(c + 1) % 3];
}

static void take_face(const deck_shape *s, box *b) {
  double middle[2];
  normal_of(s, b->axis[2]);
  take_axes(b);
  memcpy(b->centre, s->points, sizeof b->centre);
  for (int a = 0; a < 2; a++) {
    double low = INFINITY, high = -INFINITY;
    for (int k = 0; k < s->point_count; k++) {
      low = pl_fmin(low, along(b, a, s->points + 3 * k));
      high = pl_fmax(high, along(b, a, s->points + 3 * k));
    }
    b->half[a] = 0.5 * (high - low);
    middle[a] = 0.5 * (high + low);
  }
  for (int c = 0; c < 3; c++)
    b->centre[c] += middle[0] * b->axis[0][c] + middle[1] * b->axis[1][c];
}

static void take_box(const deck_shape *s, int dimensions, box *b) {
  double low[3], high[3];
  shape_box(s, low, high);
  for (int c = 0; c < dimensions; c++) {
    b->centre[c] = 0.5 * (low[c] + high[c]);
    b->half[c] = 0.5 * (high[c] - low[c]);
  }
}

static bool box_of(const deck_shape *s, int dimensions, box *b) {
  *b = (box){.axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  if (dimensions == 2) b->half[2] = INFINITY; /* the plane goes on out of itself */
  switch (s->kind) {
  case SHAPE_SEGMENT:
    take_segment(s, b);
    return true;
  case SHAPE_RECTANGLE:
    take_rectangle(s, b);
    return true;
  case SHAPE_FACE:
    take_face(s, b);
    return true;
  case SHAPE_POLYGON:
  case SHAPE_BOX:
  case SHAPE_EXTRUSION:
    take_box(s, dimensions, b);
    return true;
  default:
    return false;
  }
}

static void exchange(box *b, int p, int q) {
  const box was = *b;
  memcpy(b->axis[p], was.axis[q], sizeof was.axis[q]);
  memcpy(b->axis[q], was.axis[p], sizeof was.axis[p]);
  b->half[p] = was.half[q];
  b->half[q] = was.half[p];
}

/* --- the body about it ------------------------------------------------------------------------ */

typedef struct extent {
  double low, high;
} extent;

/* How far from a plane the bonds across it reach at most, and more. */
static double across_of(const rows *w) {
  return rows_largest_horizon(w) + rows_largest_spacing(w);
}

/* Of the particles beside the middle plane, as far as bonds across it reach; `within`: those beside
   the notch only. */
static extent extent_of(const rows *w, const box *b, int axis, bool within) {
  const double reach = b->half[NORMAL] + across_of(w);
  extent e = {INFINITY, -INFINITY};
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    double at[3];
    rows_place(w, site, at);
    if (fabs(along(b, NORMAL, at)) > reach ||
        (within && fabs(along(b, WIDTH, at)) > b->half[WIDTH] + 0.5 * rows_spacing(w, site)))
      continue;
    e.low = pl_fmin(e.low, along(b, axis, at));
    e.high = pl_fmax(e.high, along(b, axis, at));
  }
  return e;
}

/* Thinnest first; then what does not reach through the body, or is longer. */
static void put_in_order(const rows *w, box *b) {
  const double touch = 0.5 * w->spacing;
  for (int k = 1; k < AXES; k++)
    if (b->half[k] < b->half[NORMAL]) exchange(b, k, NORMAL);
  if (w->dimensions == 2) return;
  bool through[AXES];
  for (int k = DEPTH; k <= WIDTH; k++) {
    const extent e = extent_of(w, b, k, false);
    through[k] = -b->half[k] <= e.low + touch && b->half[k] >= e.high - touch;
  }
  const bool longer = b->half[WIDTH] > b->half[DEPTH];
  if (through[DEPTH] == through[WIDTH] ? longer : through[DEPTH]) exchange(b, DEPTH, WIDTH);
}

/* --- bonds across it -------------------------------------------------------------------------- */

typedef struct crossings {
  const box *box;
  double inside;       /* a place along the notch in it and in the body */
  double below, above; /* next crossings on either side of it */
} crossings;

static void note(crossings *c, double depth, double width, double touch) {
  if (fabs(width) > c->box->half[WIDTH] + touch) return;
  if (depth < c->inside)
    c->below = pl_fmax(c->below, depth);
  else
    c->above = pl_fmin(c->above, depth);
}

/* Where the bonds that a site owns cross the middle plane, or the site itself when it stands in
   it. */
static void note_bonds(const rows *w, crossings *c, long site) {
  const double touch = 1e-6 * w->spacing;
  double here[3], there[3];
  rows_place(w, site, here);
  const double d = along(c->box, NORMAL, here);
  if (fabs(d) > across_of(w)) return;
  if (fabs(d) <= touch) note(c, along(c->box, DEPTH, here), along(c->box, WIDTH, here), touch);
  for (int k = 0; k < w->directions; k++) {
    if (!rows_has_bond(w, site, k)) continue;
    rows_place(w, rows_partner(w, site, k), there);
    const double e = along(c->box, NORMAL, there);
    if (fabs(d) <= touch || fabs(e) <= touch || (d > 0) == (e > 0)) continue;
    const double part = d / (d - e);
    double at[3];
    for (int a = 0; a < 3; a++)
      at[a] = here[a] + part * (there[a] - here[a]);
    note(c, along(c->box, DEPTH, at), along(c->box, WIDTH, at), touch);
  }
}

notch_depth notch_depth_of(const rows *w, const deck_shape *notch) {
  enum { SLENDER = 4 };
  notch_depth out = {.kind = NOTCH_NONE};
  box b;
  if (!box_of(notch, w->dimensions, &b)) return out;
  put_in_order(w, &b);
  const extent body = extent_of(w, &b, DEPTH, true);
  const double low = pl_fmax(body.low, -b.half[DEPTH]), high = pl_fmin(body.high, b.half[DEPTH]);
  if (!(high > low)) return out;
  crossings c = {.box = &b, .inside = 0.5 * (low + high), .below = -INFINITY, .above = INFINITY};
  for (long p = 0; p < w->particle_count; p++)
    note_bonds(w, &c, w->particle_site[p]);
  const bool below = isfinite(c.below), above = isfinite(c.above);
  if (below && above && b.half[DEPTH] < SLENDER * b.half[NORMAL]) return out;
  out.kind = below && above ? NOTCH_INSIDE : below || above ? NOTCH_AT_EDGE : NOTCH_THROUGH;
  out.drawn = high - low;
  out.cut = pl_fmin(c.above, body.high) - pl_fmax(c.below, body.low);
  if (below) out.ligament[0] = c.below - body.low;
  if (above) out.ligament[below ? 1 : 0] = body.high - c.above;
  return out;
}
