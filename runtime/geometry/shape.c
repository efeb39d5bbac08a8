#include "runtime/geometry/shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/geometry/outline.h"

enum { NEAR_CUTS = 32 }; /* places where a chord meets an outline that need no allocation */

/* --- vectors ---------------------------------------------------------------------------------- */

static double dot(const double *a, const double *b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double size_of(const double *a) {
  return pl_hypot(pl_hypot(a[0], a[1]), a[2]);
}

static void subtract(const double *a, const double *b, double out[3]) {
  for (int c = 0; c < 3; c++)
    out[c] = a[c] - b[c];
}

/* --- outlines --------------------------------------------------------------------------------- */

/* The outline of a shape that has one, and its corners where the shape does not list them. */
typedef struct shape_outline {
  outline line;
  double points[16], bulge[8];
} shape_outline;

/* Corners given about `centre` before a turn. */
static void turn_corners(shape_outline *s, const double centre[2], double angle) {
  const double c = pl_cos(angle), d = pl_sin(angle);
  for (int k = 0; k < s->line.count; k++) {
    double *p = s->points + 2 * k;
    const double x = p[0], y = p[1];
    p[0] = centre[0] + c * x - d * y;
    p[1] = centre[1] + d * x + c * y;
  }
}

static void rectangle_outline(const deck_shape *shape, shape_outline *s) {
  const double w = shape->size[0], h = shape->size[1];
  const double x = shape->rotation == 0 ? shape->corner[0] : 0;
  const double y = shape->rotation == 0 ? shape->corner[1] : 0;
  const double corners[8] = {x, y, x + w, y, x + w, y + h, x, y + h};
  memcpy(s->points, corners, sizeof corners);
  s->line = (outline){.points = s->points, .count = 4};
  if (shape->rotation != 0) turn_corners(s, shape->corner, shape->rotation);
}

/* Arcs of the given radius, one on either side, end on the straight sides half a chord from the
   middle. */
static void dog_bone_outline(const deck_shape *shape, shape_outline *s) {
  const double w = shape->width / 2, h = shape->height / 2, rise = w - shape->neck / 2;
  const double chord = sqrt(pl_fmax(rise * (2 * shape->radius - rise), 0));
  const double corners[16] = {-w, -h, w,  -h, w,  -chord, w,  chord,
                              w,  h,  -w, h,  -w, chord,  -w, -chord};
  memcpy(s->points, corners, sizeof corners);
  memset(s->bulge, 0, sizeof s->bulge);
  s->bulge[2] = s->bulge[6] = -rise;
  s->line = (outline){.points = s->points, .bulge = s->bulge, .count = 8};
  turn_corners(s, shape->centre, shape->rotation);
}

static const outline *outline_of(const deck_shape *shape, shape_outline *s) {
  if (shape->kind == SHAPE_RECTANGLE)
    rectangle_outline(shape, s);
  else if (shape->kind == SHAPE_DOG_BONE)
    dog_bone_outline(shape, s);
  else
    s->line = (outline){shape->points, shape->bulge, shape->point_count};
  return &s->line;
}

/* --- faces ------------------------------------------------------------------------------------ */

static const double *face_corner(const deck_shape *shape, int k) {
  return shape->points + 3 * (k < shape->point_count ? k : 0);
}

/* Unit normal of the plane that the corners lie in (Newell). */
static void face_normal(const deck_shape *shape, double n[3]) {
  const double *origin = shape->points;
  memset(n, 0, 3 * sizeof *n);
  for (int k = 0; k < shape->point_count; k++) {
    double a[3], b[3];
    subtract(face_corner(shape, k), origin, a);
    subtract(face_corner(shape, k + 1), origin, b);
    for (int c = 0; c < 3; c++)
      n[c] += a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
  }
  const double size = size_of(n);
  for (int c = 0; c < 3; c++)
    n[c] /= size;
}

static double above_face(const deck_shape *shape, const double n[3], const double *p) {
  double from[3];
  subtract(p, shape->points, from);
  return dot(n, from);
}

double shape_unevenness(const deck_shape *face) {
  double n[3], extent = 0, away = 0;
  face_normal(face, n);
  for (int k = 0; k < face->point_count; k++) {
    double from[3];
    subtract(face_corner(face, k), face->points, from);
    extent = pl_fmax(extent, size_of(from));
    away = isnan(n[0]) ? NAN : pl_fmax(away, fabs(dot(n, from)));
  }
  return away / extent;
}

static double distance_to_segment(const double *p, const double *a, const double *b) {
  double along[3], from[3];
  subtract(b, a, along);
  subtract(p, a, from);
  const double square = dot(along, along);
  const double u = square > 0 ? pl_fmin(pl_fmax(dot(from, along) / square, 0), 1) : 0;
  for (int c = 0; c < 3; c++)
    from[c] -= u * along[c];
  return size_of(from);
}

/* Where the point lies over the face is asked in the coordinate plane that sees most of it. */
static bool over_face(const deck_shape *shape, const double n[3], const double *p) {
  int drop = 0;
  for (int c = 1; c < 3; c++)
    if (fabs(n[c]) > fabs(n[drop])) drop = c;
  const int x = (drop + 1) % 3, y = (drop + 2) % 3;
  const double above = above_face(shape, n, p);
  const double at[2] = {p[x] - above * n[x], p[y] - above * n[y]};
  bool inside = false;
  for (int k = 0; k < shape->point_count; k++) {
    const double *a = face_corner(shape, k), *b = face_corner(shape, k + 1);
    if ((a[y] > at[1]) == (b[y] > at[1])) continue;
    if (at[0] < a[x] + (at[1] - a[y]) / (b[y] - a[y]) * (b[x] - a[x])) inside = !inside;
  }
  return inside;
}

static double face_distance(const deck_shape *shape, const double *p) {
  double n[3], nearest = INFINITY;
  face_normal(shape, n);
  if (over_face(shape, n, p)) return fabs(above_face(shape, n, p));
  for (int k = 0; k < shape->point_count; k++)
    nearest =
        pl_fmin(nearest, distance_to_segment(p, face_corner(shape, k), face_corner(shape, k + 1)));
  return nearest;
}

/* --- cylinders -------------------------------------------------------------------------------- */

static double cylinder_axis(const deck_shape *shape, double axis[3]) {
  subtract(shape->to, shape->from, axis);
  const double length = size_of(axis);
  for (int c = 0; c < 3; c++)
    axis[c] /= length;
  return length;
}

/* Along the axis from the first end; `across` is what is left of the way there. */
static double along_axis(const deck_shape *shape, const double axis[3], const double *p,
                         double across[3]) {
  subtract(p, shape->from, across);
  const double along = dot(across, axis);
  for (int c = 0; c < 3; c++)
    across[c] -= along * axis[c];
  return along;
}

/* --- boxes of shapes -------------------------------------------------------------------------- */

static void box_about(const double *centre, double reach, int dimensions, double lower[3],
                      double upper[3]) {
  for (int c = 0; c < dimensions; c++) {
    lower[c] = centre[c] - reach;
    upper[c] = centre[c] + reach;
  }
}

/* fmin and fmax pass over what is not a number; a box must not. */
static double smaller(double a, double b) {
  return isnan(a) || isnan(b) ? NAN : pl_fmin(a, b);
}

static double larger(double a, double b) {
  return isnan(a) || isnan(b) ? NAN : pl_fmax(a, b);
}

static void box_of_ends(const double *a, const double *b, int dimensions, double lower[3],
                        double upper[3]) {
  for (int c = 0; c < dimensions; c++) {
    lower[c] = smaller(a[c], b[c]);
    upper[c] = larger(a[c], b[c]);
  }
}

static void cylinder_box(const deck_shape *shape, double lower[3], double upper[3]) {
  double axis[3];
  cylinder_axis(shape, axis);
  box_of_ends(shape->from, shape->to, 3, lower, upper);
  for (int c = 0; c < 3; c++) {
    const double reach = shape->radius * pl_hypot(axis[(c + 1) % 3], axis[(c + 2) % 3]);
    lower[c] -= reach;
    upper[c] += reach;
  }
}

static void face_box(const deck_shape *shape, double lower[3], double upper[3]) {
  box_of_ends(shape->points, shape->points, 3, lower, upper);
  for (int k = 1; k < shape->point_count; k++)
    for (int c = 0; c < 3; c++) {
      lower[c] = smaller(lower[c], face_corner(shape, k)[c]);
      upper[c] = larger(upper[c], face_corner(shape, k)[c]);
    }
}

void shape_box(const deck_shape *shape, double lower[3], double upper[3]) {
  shape_outline s;
  lower[2] = upper[2] = 0;
  switch (shape->kind) {
  case SHAPE_POINT:
    box_about(shape->at, 0, 3, lower, upper);
    return;
  case SHAPE_DISC:
    box_about(shape->centre, shape->radius, 2, lower, upper);
    return;
  case SHAPE_SPHERE:
    box_about(shape->centre, shape->radius, 3, lower, upper);
    return;
  case SHAPE_SEGMENT:
    box_of_ends(shape->from, shape->to, 2, lower, upper);
    return;
  case SHAPE_CYLINDER:
    cylinder_box(shape, lower, upper);
    return;
  case SHAPE_FACE:
    face_box(shape, lower, upper);
    return;
  case SHAPE_BOX:
    for (int c = 0; c < 3; c++) {
      lower[c] = shape->corner[c];
      upper[c] = shape->corner[c] + shape->size[c];
    }
    return;
  case SHAPE_EXTRUSION:
    lower[2] = shape->z[0];
    upper[2] = shape->z[1];
    outline_box(outline_of(shape, &s), lower, upper);
    return;
  case SHAPE_RECTANGLE:
  case SHAPE_POLYGON:
  case SHAPE_DOG_BONE:
    outline_box(outline_of(shape, &s), lower, upper);
    return;
  }
}

/* --- distances -------------------------------------------------------------------------------- */

/* Of a shape that is bounded in two directions at right angles, each with its distance. */
static double both(double a, double b) {
  return a <= 0 && b <= 0 ? pl_fmax(a, b) : pl_hypot(pl_fmax(a, 0), pl_fmax(b, 0));
}

static double round_distance(const deck_shape *shape, double from_centre) {
  const double outside = from_centre - shape->radius;
  return shape->inner_radius > 0 ? pl_fmax(outside, shape->inner_radius - from_centre) : outside;
}

static double between(double x, double low, double high) {
  return pl_fmax(low - x, x - high);
}

static double cylinder_distance(const deck_shape *shape, const double *p) {
  double axis[3], across[3];
  const double length = cylinder_axis(shape, axis);
  const double along = along_axis(shape, axis, p, across);
  return both(round_distance(shape, size_of(across)), between(along, 0, length));
}

static double box_distance(const deck_shape *shape, const double *p) {
  double d[3];
  for (int c = 0; c < 3; c++)
    d[c] = between(p[c], shape->corner[c], shape->corner[c] + shape->size[c]);
  return both(both(d[0], d[1]), d[2]);
}

double shape_distance(const deck_shape *shape, const double *p) {
  shape_outline s;
  double from[3];
  switch (shape->kind) {
  case SHAPE_POINT:
    subtract(p, shape->at, from);
    return size_of(from);
  case SHAPE_DISC:
    return round_distance(shape, pl_hypot(p[0] - shape->centre[0], p[1] - shape->centre[1]));
  case SHAPE_SPHERE:
    subtract(p, shape->centre, from);
    return round_distance(shape, size_of(from));
  case SHAPE_CYLINDER:
    return cylinder_distance(shape, p);
  case SHAPE_BOX:
    return box_distance(shape, p);
  case SHAPE_FACE:
    return face_distance(shape, p);
  case SHAPE_SEGMENT: {
    const double at[3] = {p[0], p[1], 0};
    return distance_to_segment(at, shape->from, shape->to);
  }
  case SHAPE_EXTRUSION:
    return both(outline_distance(outline_of(shape, &s), p),
                between(p[2], shape->z[0], shape->z[1]));
  case SHAPE_RECTANGLE:
  case SHAPE_POLYGON:
  case SHAPE_DOG_BONE:
    return outline_distance(outline_of(shape, &s), p);
  }
  return INFINITY;
}

bool shape_contains(const deck_shape *shape, const double *point, double tolerance) {
  return shape_distance(shape, point) <= tolerance;
}

/* --- places where a chord meets the surface --------------------------------------------------- */

/* Places u (0 at a, 1 at b) where a chord meets the surface, or its continuation; `near` serves
   unless there are very many. */
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

/* Where `at` + u `way` is `radius` from the origin. */
static void cut_by_round(cuts *c, const double at[3], const double way[3], double radius) {
  const double square = dot(way, way), half = dot(at, way);
  const double rest = half * half - square * (dot(at, at) - radius * radius);
  if (!(square > 0 && rest > 0)) return;
  cuts_add(c, (-half - sqrt(rest)) / square);
  cuts_add(c, (-half + sqrt(rest)) / square);
}

static void cut_by_circle(cuts *c, const double *a, const double *b, const double *centre,
                          double radius) {
  const double at[3] = {a[0] - centre[0], a[1] - centre[1], 0};
  const double way[3] = {b[0] - a[0], b[1] - a[1], 0};
  cut_by_round(c, at, way, radius);
}

/* Where a value that goes evenly from `at_a` to `at_b` is 0. */
static void cut_by_level(cuts *c, double at_a, double at_b) {
  if (at_a != at_b) cuts_add(c, at_a / (at_a - at_b));
}

static void cut_by_straight(cuts *c, const double *a, const double *b, const double *p,
                            const double *q) {
  const double ex = b[0] - a[0], ey = b[1] - a[1];
  const double side_p = ex * (p[1] - a[1]) - ey * (p[0] - a[0]);
  const double side_q = ex * (q[1] - a[1]) - ey * (q[0] - a[0]);
  if (side_p == side_q || (side_p > 0 && side_q > 0) || (side_p < 0 && side_q < 0)) return;
  const double v = side_p / (side_p - side_q);
  const double x = p[0] + v * (q[0] - p[0]), y = p[1] + v * (q[1] - p[1]);
  cuts_add(c, ((x - a[0]) * ex + (y - a[1]) * ey) / (ex * ex + ey * ey));
}

static void cut_by_outline(cuts *c, const double *a, const double *b, const outline *o) {
  for (int k = 0; k < o->count; k++) {
    double centre[2], radius;
    if (outline_arc(o, k, centre, &radius))
      cut_by_circle(c, a, b, centre, radius);
    else
      cut_by_straight(c, a, b, outline_corner(o, k), outline_corner(o, k + 1));
  }
}

static void cut_by_cylinder(cuts *c, const double *a, const double *b, const deck_shape *shape) {
  double axis[3], at[3], there[3], way[3];
  const double length = cylinder_axis(shape, axis);
  const double along_a = along_axis(shape, axis, a, at),
               along_b = along_axis(shape, axis, b, there);
  subtract(there, at, way);
  cut_by_level(c, along_a, along_b);
  cut_by_level(c, along_a - length, along_b - length);
  cut_by_round(c, at, way, shape->radius);
  if (shape->inner_radius > 0) cut_by_round(c, at, way, shape->inner_radius);
}

static void cut_by_sphere(cuts *c, const double *a, const double *b, const deck_shape *shape) {
  double at[3], way[3];
  subtract(a, shape->centre, at);
  subtract(b, a, way);
  cut_by_round(c, at, way, shape->radius);
  if (shape->inner_radius > 0) cut_by_round(c, at, way, shape->inner_radius);
}

static void cut_by_shape(cuts *c, const double *a, const double *b, const deck_shape *shape) {
  shape_outline s;
  switch (shape->kind) {
  case SHAPE_DISC:
    cut_by_circle(c, a, b, shape->centre, shape->radius);
    if (shape->inner_radius > 0) cut_by_circle(c, a, b, shape->centre, shape->inner_radius);
    return;
  case SHAPE_SPHERE:
    cut_by_sphere(c, a, b, shape);
    return;
  case SHAPE_CYLINDER:
    cut_by_cylinder(c, a, b, shape);
    return;
  case SHAPE_BOX:
    for (int k = 0; k < 3; k++) {
      const double low = shape->corner[k], high = low + shape->size[k];
      cut_by_level(c, a[k] - low, b[k] - low);
      cut_by_level(c, a[k] - high, b[k] - high);
    }
    return;
  case SHAPE_EXTRUSION:
    for (int end = 0; end < 2; end++)
      cut_by_level(c, a[2] - shape->z[end], b[2] - shape->z[end]);
    cut_by_outline(c, a, b, outline_of(shape, &s));
    return;
  case SHAPE_RECTANGLE:
  case SHAPE_POLYGON:
  case SHAPE_DOG_BONE:
    cut_by_outline(c, a, b, outline_of(shape, &s));
    return;
  case SHAPE_POINT:
  case SHAPE_SEGMENT:
  case SHAPE_FACE:
    return;
  }
}

bool shape_has_size(const deck_shape *shape) {
  return shape->kind != SHAPE_POINT && shape->kind != SHAPE_SEGMENT && shape->kind != SHAPE_FACE;
}

int shape_cuts(const deck_shape *shape, const double *a, const double *b, double *u, int most) {
  cuts c = {.count = 0, .capacity = NEAR_CUTS};
  c.all = c.near;
  cut_by_shape(&c, a, b, shape);
  const int count = c.count;
  memcpy(u, c.all, (size_t)(count < most ? count : most) * sizeof *u);
  if (c.all != c.near) free(c.all);
  return count;
}

/* --- ways along the outline ------------------------------------------------------------------- */

static double disc_way(const deck_shape *shape, const double *p, const double *q) {
  const double a[2] = {p[0] - shape->centre[0], p[1] - shape->centre[1]},
               b[2] = {q[0] - shape->centre[0], q[1] - shape->centre[1]};
  const double between = 0.5 * (shape->radius + shape->inner_radius);
  const bool outer = pl_hypot(a[0], a[1]) > between;
  if (outer != (pl_hypot(b[0], b[1]) > between)) return INFINITY;
  return (outer ? shape->radius : shape->inner_radius) *
         fabs(pl_atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]));
}

double shape_way(const deck_shape *shape, const double *p, const double *q) {
  shape_outline s;
  return shape->kind == SHAPE_DISC ? disc_way(shape, p, q)
                                   : outline_way(outline_of(shape, &s), p, q);
}

/* --- corners ---------------------------------------------------------------------------------- */

static bool has_outline(const deck_shape *shape) {
  return shape->kind == SHAPE_RECTANGLE || shape->kind == SHAPE_DOG_BONE ||
         shape->kind == SHAPE_POLYGON || shape->kind == SHAPE_EXTRUSION;
}

int shape_levels(const deck_shape *shape, int c, double *level, int most) {
  double lower[3], upper[3];
  int count = 0;
  shape_box(shape, lower, upper);
  if (count++ < most) level[0] = lower[c];
  if (count++ < most) level[1] = upper[c];
  if (shape->kind == SHAPE_DISC)
    for (int side = -1; side <= 1; side += 2, count++)
      if (count < most) level[count] = shape->centre[c] + side * shape->inner_radius;
  if (!has_outline(shape) || c == 2) return count;
  shape_outline s;
  const outline *o = outline_of(shape, &s);
  for (int k = 0; k < o->count; k++, count++)
    if (count < most) level[count] = outline_corner(o, k)[c];
  return count;
}

bool shape_is_convex(const deck_shape *shape) {
  if (shape->kind == SHAPE_RECTANGLE || shape->kind == SHAPE_BOX) return true;
  return (shape->kind == SHAPE_DISC || shape->kind == SHAPE_CYLINDER ||
          shape->kind == SHAPE_SPHERE) &&
         shape->inner_radius == 0;
}

/* --- crossings -------------------------------------------------------------------------------- */

static bool is_of_space(const deck_shape *shape) {
  return shape->kind >= SHAPE_BOX;
}

static int ascending(const void *p, const void *q) {
  const double a = *(const double *)p, b = *(const double *)q;
  return (a > b) - (a < b);
}

/* Between two places where the chord meets the surface it is inside or outside throughout: ask in
 * the middle. */
static bool deep_between_cuts(cuts *c, const deck_shape *shape, const double *a, const double *b,
                              double tolerance) {
  const int dimensions = is_of_space(shape) ? 3 : 2;
  qsort(c->all, (size_t)c->count, sizeof c->all[0], ascending);
  double from = 0;
  for (int k = 0; k <= c->count; k++) {
    const double to = k < c->count ? c->all[k] : 1, u = (from + to) / 2;
    double middle[3] = {0, 0, 0};
    for (int d = 0; d < dimensions; d++)
      middle[d] = a[d] + u * (b[d] - a[d]);
    if (shape_distance(shape, middle) < -tolerance) return true;
    from = to;
  }
  return false;
}

/* Distance of p from the line a-b, positive to its left. */
static double left_of(const double *p, const double *a, const double *b) {
  const double ex = b[0] - a[0], ey = b[1] - a[1];
  return (ex * (p[1] - a[1]) - ey * (p[0] - a[0])) / pl_hypot(ex, ey);
}

static bool crosses_slit(const double *a, const double *b, const double *p, const double *q,
                         double tolerance) {
  if (pl_hypot(q[0] - p[0], q[1] - p[1]) <= tolerance) return false;
  const double side_a = left_of(a, p, q), side_b = left_of(b, p, q);
  if (pl_fmin(side_a, side_b) >= -tolerance || pl_fmax(side_a, side_b) <= tolerance) return false;
  const double side_p = left_of(p, a, b), side_q = left_of(q, a, b);
  return pl_fmin(side_p, side_q) <= tolerance && pl_fmax(side_p, side_q) >= -tolerance;
}

static bool crosses_face(const deck_shape *shape, const double *a, const double *b,
                         double tolerance) {
  double n[3], at[3];
  face_normal(shape, n);
  const double side_a = above_face(shape, n, a), side_b = above_face(shape, n, b);
  if (pl_fmin(side_a, side_b) >= -tolerance || pl_fmax(side_a, side_b) <= tolerance) return false;
  for (int c = 0; c < 3; c++)
    at[c] = a[c] + side_a / (side_a - side_b) * (b[c] - a[c]);
  return face_distance(shape, at) <= tolerance;
}

static bool crosses_fold(const outline *o, const double *a, const double *b, double tolerance) {
  for (int k = 0; k < o->count; k++)
    if (crosses_slit(a, b, outline_corner(o, k), outline_corner(o, k + 1), tolerance)) return true;
  return false;
}

static bool has_flat_outline(const deck_shape *shape, double tolerance) {
  shape_outline s;
  const bool outlined = shape->kind == SHAPE_RECTANGLE || shape->kind == SHAPE_POLYGON;
  return outlined && outline_is_flat(outline_of(shape, &s), tolerance);
}

static bool boxes_apart(const deck_shape *shape, const double *a, const double *b,
                        double tolerance) {
  double lower[3], upper[3];
  shape_box(shape, lower, upper);
  for (int c = 0; c < (is_of_space(shape) ? 3 : 2); c++) {
    if (pl_fmin(a[c], b[c]) > upper[c] + tolerance) return true;
    if (pl_fmax(a[c], b[c]) < lower[c] - tolerance) return true;
  }
  return false;
}

bool shape_crossed(const deck_shape *shape, const double *a, const double *b, double tolerance) {
  shape_outline s;
  if (shape->kind == SHAPE_POINT || boxes_apart(shape, a, b, tolerance)) return false;
  if (shape->kind == SHAPE_SEGMENT) return crosses_slit(a, b, shape->from, shape->to, tolerance);
  if (shape->kind == SHAPE_FACE) return crosses_face(shape, a, b, tolerance);
  if (has_flat_outline(shape, tolerance))
    return crosses_fold(outline_of(shape, &s), a, b, tolerance);
  cuts c = {.count = 0, .capacity = NEAR_CUTS};
  c.all = c.near;
  cut_by_shape(&c, a, b, shape);
  const bool crossed = deep_between_cuts(&c, shape, a, b, tolerance);
  if (c.all != c.near) free(c.all);
  return crossed;
}
