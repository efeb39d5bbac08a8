#include "runtime/geometry/outline.h"

#include <math.h>

#include "dsl/base/elementary.h"

const double *outline_corner(const outline *o, int k) {
  return o->points + 2 * (k < o->count ? k : 0);
}

/* An edge that is part of a circle: its points lie on the outer side of the chord when it rises
   outward, counter- clockwise from a to b, and else on the inner side, clockwise. */
typedef struct arc {
  double centre[2], radius;
  double middle[2], outward[2]; /* of the chord */
  double rise;
} arc;

static bool arc_of(const outline *o, int k, arc *out) {
  const double rise = o->bulge ? o->bulge[k] : 0;
  const double *a = outline_corner(o, k), *b = outline_corner(o, k + 1);
  const double ex = b[0] - a[0], ey = b[1] - a[1], length = pl_hypot(ex, ey);
  if (rise == 0 || length == 0) return false;
  *out = (arc){.radius = (0.25 * length * length + rise * rise) / (2 * fabs(rise)),
               .middle = {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])},
               .outward = {ey / length, -ex / length},
               .rise = rise};
  for (int c = 0; c < 2; c++)
    out->centre[c] = out->middle[c] + (rise - copysign(out->radius, rise)) * out->outward[c];
  return true;
}

bool outline_arc(const outline *o, int k, double centre[2], double *radius) {
  arc edge;
  if (!arc_of(o, k, &edge)) return false;
  centre[0] = edge.centre[0];
  centre[1] = edge.centre[1];
  *radius = edge.radius;
  return true;
}

/* Positive where a point of the circle belongs to the arc, 0 at its ends. */
static double beyond_chord(const arc *e, double x, double y) {
  return e->rise * ((x - e->middle[0]) * e->outward[0] + (y - e->middle[1]) * e->outward[1]);
}

static bool on_arc(const arc *e, double x, double y) {
  return beyond_chord(e, x, y) >= 0;
}

/* --- box -------------------------------------------------------------------------------------- */

/* fmin and fmax pass over what is not a number; a box must not. */
static void widen(double lower[2], double upper[2], double x, double y) {
  const double p[2] = {x, y};
  for (int c = 0; c < 2; c++) {
    lower[c] = isnan(lower[c]) || isnan(p[c]) ? NAN : pl_fmin(lower[c], p[c]);
    upper[c] = isnan(upper[c]) || isnan(p[c]) ? NAN : pl_fmax(upper[c], p[c]);
  }
}

void outline_box(const outline *o, double lower[2], double upper[2]) {
  static const double extremes[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  lower[0] = lower[1] = INFINITY;
  upper[0] = upper[1] = -INFINITY;
  for (int k = 0; k < o->count; k++) {
    const double *a = outline_corner(o, k);
    arc edge;
    widen(lower, upper, a[0], a[1]);
    if (!arc_of(o, k, &edge)) continue;
    for (int m = 0; m < 4; m++) {
      const double x = edge.centre[0] + edge.radius * extremes[m][0];
      const double y = edge.centre[1] + edge.radius * extremes[m][1];
      if (on_arc(&edge, x, y)) widen(lower, upper, x, y);
    }
  }
}

/* --- distance --------------------------------------------------------------------------------- */

static double distance_to_straight(const double p[2], const double a[2], const double b[2]) {
  const double ex = b[0] - a[0], ey = b[1] - a[1];
  const double square = ex * ex + ey * ey;
  const double along = (p[0] - a[0]) * ex + (p[1] - a[1]) * ey;
  const double u = square > 0 ? pl_fmin(pl_fmax(along / square, 0), 1) : 0;
  return pl_hypot(p[0] - a[0] - u * ex, p[1] - a[1] - u * ey);
}

static double distance_to_arc(const double p[2], const arc *e, const double a[2],
                              const double b[2]) {
  const double x = p[0] - e->centre[0], y = p[1] - e->centre[1], from_centre = pl_hypot(x, y);
  const double factor = e->radius / from_centre; /* at the centre all points are equally far */
  if (from_centre > 0 && on_arc(e, e->centre[0] + factor * x, e->centre[1] + factor * y))
    return fabs(from_centre - e->radius);
  return pl_fmin(pl_hypot(p[0] - a[0], p[1] - a[1]), pl_hypot(p[0] - b[0], p[1] - b[1]));
}

/* Does the ray from p toward +x cross a-b? Half open in y, so that a corner counts once. */
static bool ray_crosses(const double p[2], const double a[2], const double b[2]) {
  if ((a[1] > p[1]) == (b[1] > p[1])) return false;
  return p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
}

/* The same for a piece of an arc that rises or falls throughout, from the height y0 to y1. */
static bool ray_crosses_piece(const double p[2], const arc *e, double y0, double y1) {
  if ((y0 > p[1]) == (y1 > p[1])) return false;
  const double up = p[1] - e->centre[1], square = e->radius * e->radius - up * up;
  const bool on_the_right = (y1 > y0) == (e->rise > 0);
  const double x = square > 0 ? sqrt(square) : 0;
  return p[0] < e->centre[0] + (on_the_right ? x : -x);
}

/* An arc turns back in y at the top and at the bottom of its circle, but not where it ends there: a
   half circle on an upright chord rises or falls throughout. */
static int ray_crossings(const double p[2], const arc *e, const double a[2], const double b[2]) {
  const double top = e->centre[1] + e->radius, bottom = e->centre[1] - e->radius;
  const bool climbs = (a[0] >= e->centre[0]) == (e->rise > 0);
  const double turns[2] = {climbs ? top : bottom, climbs ? bottom : top};
  double y = a[1];
  int count = 0;
  for (int k = 0; k < 2; k++) {
    if (!(beyond_chord(e, e->centre[0], turns[k]) > 0)) continue;
    count += ray_crosses_piece(p, e, y, turns[k]);
    y = turns[k];
  }
  return count + ray_crosses_piece(p, e, y, b[1]);
}

double outline_distance(const outline *o, const double p[2]) {
  double nearest = INFINITY;
  int crossings = 0;
  for (int k = 0; k < o->count; k++) {
    const double *a = outline_corner(o, k), *b = outline_corner(o, k + 1);
    arc edge;
    if (arc_of(o, k, &edge)) {
      nearest = pl_fmin(nearest, distance_to_arc(p, &edge, a, b));
      crossings += ray_crossings(p, &edge, a, b);
    } else {
      nearest = pl_fmin(nearest, distance_to_straight(p, a, b));
      crossings += ray_crosses(p, a, b);
    }
  }
  return crossings % 2 ? -nearest : nearest;
}

/* --- ways along it ---------------------------------------------------------------------------- */

/* Turn from a to p about the arc's centre, 0 to 2 pi, in the direction in which the arc runs. */
static double turn_to(const arc *e, const double a[2], const double p[2]) {
  const double x = a[0] - e->centre[0], y = a[1] - e->centre[1], u = p[0] - e->centre[0],
               v = p[1] - e->centre[1], sense = e->rise > 0 ? 1 : -1;
  const double turn = pl_atan2(sense * (x * v - y * u), x * u + y * v);
  return turn < 0 ? turn + 2 * M_PI : turn;
}

/* From the first corner to a point of the outline; *whole: all of it. */
static double way_to(const outline *o, const double p[2], double *whole) {
  double nearest = INFINITY, way = 0;
  *whole = 0;
  for (int k = 0; k < o->count; k++) {
    const double *a = outline_corner(o, k), *b = outline_corner(o, k + 1);
    arc edge;
    const bool round = arc_of(o, k, &edge);
    const double off = round ? distance_to_arc(p, &edge, a, b) : distance_to_straight(p, a, b);
    const double length =
        round ? edge.radius * turn_to(&edge, a, b) : pl_hypot(b[0] - a[0], b[1] - a[1]);
    if (off < nearest) {
      const double along =
          round ? edge.radius * turn_to(&edge, a, p) : pl_hypot(p[0] - a[0], p[1] - a[1]);
      nearest = off;
      way = *whole + pl_fmin(along, length);
    }
    *whole += length;
  }
  return way;
}

double outline_way(const outline *o, const double p[2], const double q[2]) {
  double whole;
  const double way = fabs(way_to(o, p, &whole) - way_to(o, q, &whole));
  return pl_fmin(way, whole - way);
}

bool outline_is_flat(const outline *o, double tolerance) {
  double twice = 0, perimeter = 0;
  for (int k = 0; k < o->count; k++) {
    const double *a = outline_corner(o, k), *b = outline_corner(o, k + 1), *c = o->points;
    if (o->bulge && o->bulge[k] != 0) return false;
    twice += (a[0] - c[0]) * (b[1] - c[1]) - (a[1] - c[1]) * (b[0] - c[0]);
    perimeter += pl_hypot(b[0] - a[0], b[1] - a[1]);
  }
  return fabs(twice) <= tolerance * perimeter;
}
