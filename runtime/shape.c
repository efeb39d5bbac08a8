#include "runtime/shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"

enum { NEAR_CUTS = 32 }; /* places where a chord meets an outline that need no allocation */

/* Corners in order; a rectangle becomes a polygon so that both share one path. */
typedef struct outline {
  const double *points;
  int count;
  double corners[8];
} outline;

static void outline_of(const deck_shape *shape, outline *o) {
  if (shape->kind == SHAPE_POLYGON) {
    o->points = shape->points;
    o->count = shape->point_count;
    return;
  }
  const double x = shape->corner[0], y = shape->corner[1];
  const double w = shape->size[0], h = shape->size[1];
  const double corners[8] = {x, y, x + w, y, x + w, y + h, x, y + h};
  memcpy(o->corners, corners, sizeof corners);
  o->points = o->corners;
  o->count = 4;
}

static const double *next_point(const outline *o, int k) {
  return o->points + 2 * (k + 1 < o->count ? k + 1 : 0);
}

/* fmin and fmax pass over what is not a number; a box must not. */
static void box_of_points(const outline *o, double lower[2], double upper[2]) {
  for (int c = 0; c < 2; c++) {
    lower[c] = INFINITY;
    upper[c] = -INFINITY;
    for (int k = 0; k < o->count; k++) {
      const double x = o->points[2 * k + c];
      lower[c] = isnan(lower[c]) || isnan(x) ? NAN : fmin(lower[c], x);
      upper[c] = isnan(upper[c]) || isnan(x) ? NAN : fmax(upper[c], x);
    }
  }
}

void shape_box(const deck_shape *shape, double lower[3], double upper[3]) {
  outline o;
  const double *middle = shape->kind == SHAPE_DISC ? shape->centre : shape->at;
  const double reach = shape->kind == SHAPE_DISC ? shape->radius : 0;
  lower[2] = upper[2] = 0;
  switch (shape->kind) {
  case SHAPE_POINT:
  case SHAPE_DISC:
    for (int c = 0; c < 2; c++) {
      lower[c] = middle[c] - reach;
      upper[c] = middle[c] + reach;
    }
    return;
  case SHAPE_RECTANGLE:
  case SHAPE_POLYGON:
    outline_of(shape, &o);
    box_of_points(&o, lower, upper);
    return;
  }
}

static double distance_to_segment(const double p[2], const double a[2], const double b[2]) {
  const double ex = b[0] - a[0], ey = b[1] - a[1];
  const double square = ex * ex + ey * ey;
  const double along = (p[0] - a[0]) * ex + (p[1] - a[1]) * ey;
  const double u = square > 0 ? fmin(fmax(along / square, 0), 1) : 0;
  return hypot(p[0] - a[0] - u * ex, p[1] - a[1] - u * ey);
}

/* Does the ray from p toward +x cross a-b? Half open in y, so that a corner counts once. */
static bool ray_crosses(const double p[2], const double a[2], const double b[2]) {
  if ((a[1] > p[1]) == (b[1] > p[1])) return false;
  return p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
}

/* Distance to the outline, negative inside. */
static double signed_distance(const outline *o, const double p[2]) {
  double nearest = INFINITY;
  bool inside = false;
  for (int k = 0; k < o->count; k++) {
    const double *a = o->points + 2 * k, *b = next_point(o, k);
    nearest = fmin(nearest, distance_to_segment(p, a, b));
    if (ray_crosses(p, a, b)) inside = !inside;
  }
  return inside ? -nearest : nearest;
}

static double shape_distance(const deck_shape *shape, const double p[2]) {
  outline o;
  switch (shape->kind) {
  case SHAPE_POINT:
    return hypot(p[0] - shape->at[0], p[1] - shape->at[1]);
  case SHAPE_DISC: {
    const double r = hypot(p[0] - shape->centre[0], p[1] - shape->centre[1]);
    const double outside = r - shape->radius;
    return shape->inner_radius > 0 ? fmax(outside, shape->inner_radius - r) : outside;
  }
  case SHAPE_RECTANGLE:
  case SHAPE_POLYGON:
    outline_of(shape, &o);
    return signed_distance(&o, p);
  }
  return INFINITY;
}

bool shape_contains(const deck_shape *shape, const double *point, double tolerance) {
  return shape_distance(shape, point) <= tolerance;
}

/* Places u (0 at a, 1 at b) where a chord meets an outline; `near` serves unless there are very
 * many. */
typedef struct cuts {
  double near[NEAR_CUTS];
  double *all;
  int count, capacity;
} cuts;

static void cuts_add(cuts *c, double u) {
  if (!(u > 0 && u < 1)) return;
  if (c->count == c->capacity) {
    const size_t half = (size_t)c->capacity * sizeof(double);
    double *more = must_alloc(2 * half);
    memcpy(more, c->all, half);
    if (c->all != c->near) free(c->all);
    c->all = more;
    c->capacity *= 2;
  }
  c->all[c->count++] = u;
}

static void cut_by_circle(cuts *c, const double a[2], const double b[2], const double centre[2],
                          double radius) {
  const double ex = b[0] - a[0], ey = b[1] - a[1];
  const double ax = a[0] - centre[0], ay = a[1] - centre[1];
  const double square = ex * ex + ey * ey, half = ax * ex + ay * ey;
  const double rest = half * half - square * (ax * ax + ay * ay - radius * radius);
  if (!(square > 0 && rest > 0)) return;
  cuts_add(c, (-half - sqrt(rest)) / square);
  cuts_add(c, (-half + sqrt(rest)) / square);
}

static void cut_by_segment(cuts *c, const double a[2], const double b[2], const double p[2],
                           const double q[2]) {
  const double ex = b[0] - a[0], ey = b[1] - a[1];
  const double side_p = ex * (p[1] - a[1]) - ey * (p[0] - a[0]);
  const double side_q = ex * (q[1] - a[1]) - ey * (q[0] - a[0]);
  if (side_p == side_q || (side_p > 0 && side_q > 0) || (side_p < 0 && side_q < 0)) return;
  const double v = side_p / (side_p - side_q);
  const double x = p[0] + v * (q[0] - p[0]), y = p[1] + v * (q[1] - p[1]);
  cuts_add(c, ((x - a[0]) * ex + (y - a[1]) * ey) / (ex * ex + ey * ey));
}

static int ascending(const void *p, const void *q) {
  const double a = *(const double *)p, b = *(const double *)q;
  return (a > b) - (a < b);
}

/* Between two places where the chord meets the outline it is inside or outside throughout: ask in
 * the middle. */
static bool deep_between_cuts(cuts *c, const deck_shape *shape, const double a[2],
                              const double b[2], double tolerance) {
  qsort(c->all, (size_t)c->count, sizeof c->all[0], ascending);
  double from = 0;
  for (int k = 0; k <= c->count; k++) {
    const double to = k < c->count ? c->all[k] : 1, u = (from + to) / 2;
    const double middle[2] = {a[0] + u * (b[0] - a[0]), a[1] + u * (b[1] - a[1])};
    if (shape_distance(shape, middle) < -tolerance) return true;
    from = to;
  }
  return false;
}

/* Distance of p from the line a-b, positive to its left. */
static double left_of(const double p[2], const double a[2], const double b[2]) {
  const double ex = b[0] - a[0], ey = b[1] - a[1];
  return (ex * (p[1] - a[1]) - ey * (p[0] - a[0])) / hypot(ex, ey);
}

static bool crosses_slit(const double a[2], const double b[2], const double p[2], const double q[2],
                         double tolerance) {
  if (hypot(q[0] - p[0], q[1] - p[1]) <= tolerance) return false;
  const double side_a = left_of(a, p, q), side_b = left_of(b, p, q);
  if (fmin(side_a, side_b) >= -tolerance || fmax(side_a, side_b) <= tolerance) return false;
  const double side_p = left_of(p, a, b), side_q = left_of(q, a, b);
  return fmin(side_p, side_q) <= tolerance && fmax(side_p, side_q) >= -tolerance;
}

static bool without_area(const outline *o, double tolerance) {
  double twice = 0, perimeter = 0;
  for (int k = 0; k < o->count; k++) {
    const double *a = o->points + 2 * k, *b = next_point(o, k), *c = o->points;
    twice += (a[0] - c[0]) * (b[1] - c[1]) - (a[1] - c[1]) * (b[0] - c[0]);
    perimeter += hypot(b[0] - a[0], b[1] - a[1]);
  }
  return fabs(twice) <= tolerance * perimeter;
}

static bool outline_crossed(const deck_shape *shape, const double a[2], const double b[2],
                            double tolerance, cuts *c) {
  outline o;
  outline_of(shape, &o);
  if (without_area(&o, tolerance)) {
    for (int k = 0; k < o.count; k++)
      if (crosses_slit(a, b, o.points + 2 * k, next_point(&o, k), tolerance)) return true;
    return false;
  }
  for (int k = 0; k < o.count; k++)
    cut_by_segment(c, a, b, o.points + 2 * k, next_point(&o, k));
  return deep_between_cuts(c, shape, a, b, tolerance);
}

static bool boxes_apart(const deck_shape *shape, const double a[2], const double b[2],
                        double tolerance) {
  double lower[3], upper[3];
  shape_box(shape, lower, upper);
  for (int c = 0; c < 2; c++) {
    if (fmin(a[c], b[c]) > upper[c] + tolerance) return true;
    if (fmax(a[c], b[c]) < lower[c] - tolerance) return true;
  }
  return false;
}

bool shape_crossed(const deck_shape *shape, const double *a, const double *b, double tolerance) {
  if (shape->kind == SHAPE_POINT || boxes_apart(shape, a, b, tolerance)) return false;
  cuts c = {.count = 0, .capacity = NEAR_CUTS};
  c.all = c.near;
  bool crossed;
  if (shape->kind == SHAPE_DISC) {
    cut_by_circle(&c, a, b, shape->centre, shape->radius);
    if (shape->inner_radius > 0) cut_by_circle(&c, a, b, shape->centre, shape->inner_radius);
    crossed = deep_between_cuts(&c, shape, a, b, tolerance);
  } else {
    crossed = outline_crossed(shape, a, b, tolerance, &c);
  }
  if (c.all != c.near) free(c.all);
  return crossed;
}
