#include "runtime/geometry/surface.h"

#include <math.h>
#include <string.h>

#include "dsl/base/elementary.h"

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double size_of(const double a[3]) {
  return sqrt(dot(a, a));
}

/* --- set-up ----------------------------------------------------------------------------------- */

static void along_axes(surface *s) {
  for (int a = 0; a < 3; a++)
    for (int c = 0; c < 3; c++)
      s->axes[a][c] = a == c;
}

static void open_rectangle(const deck_shape *shape, surface *s) {
  const double c = pl_cos(shape->rotation), d = pl_sin(shape->rotation);
  if (shape->rotation != 0) {
    s->axes[0][0] = s->axes[1][1] = c;
    s->axes[0][1] = d;
    s->axes[1][0] = -d;
  }
  for (int a = 0; a < 2; a++) {
    s->half[a] = 0.5 * shape->size[a];
    s->centre[a] = shape->corner[a];
  }
  for (int a = 0; a < 2; a++)
    for (int k = 0; k < 2; k++)
      s->centre[a] += s->half[k] * s->axes[k][a];
  s->half[2] = INFINITY;
}

static void open_box(const deck_shape *shape, surface *s) {
  for (int a = 0; a < 3; a++) {
    s->half[a] = 0.5 * shape->size[a];
    s->centre[a] = shape->corner[a] + s->half[a];
  }
}

static void open_ball(const deck_shape *shape, int dimensions, surface *s) {
  memcpy(s->centre, shape->centre, (size_t)dimensions * sizeof(double));
  s->half[0] = shape->radius;
}

/* A unit vector across another, along the coordinate axis that is most so. */
static void one_across(const double axis[3], double across[3]) {
  int least = 0;
  for (int c = 1; c < 3; c++)
    if (fabs(axis[c]) < fabs(axis[least])) least = c;
  for (int c = 0; c < 3; c++)
    across[c] = (c == least) - axis[least] * axis[c];
  const double size = size_of(across);
  for (int c = 0; c < 3; c++)
    across[c] /= size;
}

static void open_cylinder(const deck_shape *shape, surface *s) {
  double length[3];
  for (int c = 0; c < 3; c++) {
    length[c] = shape->to[c] - shape->from[c];
    s->centre[c] = 0.5 * (shape->from[c] + shape->to[c]);
  }
  const double size = size_of(length);
  for (int c = 0; c < 3; c++)
    s->axes[0][c] = length[c] / size;
  one_across(s->axes[0], s->axes[1]);
  for (int c = 0; c < 3; c++) {
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    s->axes[2][c] = s->axes[0][a] * s->axes[1][b] - s->axes[0][b] * s->axes[1][a];
  }
  s->half[0] = 0.5 * size;
  s->half[1] = shape->radius;
}

bool surface_open(const deck_shape *shape, surface *s) {
  static const surface_kind kinds[] = {[SHAPE_RECTANGLE] = SURFACE_BOX,
                                       [SHAPE_BOX] = SURFACE_BOX,
                                       [SHAPE_DISC] = SURFACE_BALL,
                                       [SHAPE_SPHERE] = SURFACE_BALL,
                                       [SHAPE_CYLINDER] = SURFACE_CYLINDER};
  memset(s, 0, sizeof *s);
  along_axes(s);
  switch (shape->kind) {
  case SHAPE_RECTANGLE:
    open_rectangle(shape, s);
    break;
  case SHAPE_BOX:
    open_box(shape, s);
    break;
  case SHAPE_DISC:
    open_ball(shape, 2, s);
    break;
  case SHAPE_SPHERE:
    open_ball(shape, 3, s);
    break;
  case SHAPE_CYLINDER:
    open_cylinder(shape, s);
    break;
  default:
    return false;
  }
  s->kind = kinds[shape->kind];
  return true;
}

enum { LENGTHS = 1, AXES = LENGTHS + 6 };

void surface_numbers(const surface *s, double numbers[SURFACE_NUMBERS]) {
  numbers[0] = s->kind;
  for (int c = 0; c < 3; c++) {
    numbers[LENGTHS + c] = s->centre[c];
    numbers[LENGTHS + 3 + c] = isinf(s->half[c]) ? 0 : s->half[c];
    for (int a = 0; a < 3; a++)
      numbers[AXES + 3 * a + c] = s->axes[a][c];
  }
}

bool surface_is_alike(const double a[SURFACE_NUMBERS], const double b[SURFACE_NUMBERS]) {
  const double rounding = 1e-9;
  double size = 0;
  bool alike = a[0] == b[0];
  for (int k = LENGTHS; k < AXES; k++)
    size = pl_fmax(size, fabs(a[k]));
  for (int k = LENGTHS; k < SURFACE_NUMBERS; k++)
    alike = alike && fabs(a[k] - b[k]) <= rounding * (k < AXES ? size : 1);
  return alike;
}

/* --- distances -------------------------------------------------------------------------------- */

/* Of a point x from the middle of a box with these half edges, in its own axes. Inside the nearest
   face counts, of several the first. */
static double from_box(const double *x, const double *half, int count, double *out) {
  double away[3], square = 0;
  int nearest = 0;
  for (int a = 0; a < count; a++) {
    away[a] = fabs(x[a]) - half[a];
    if (away[a] > away[nearest]) nearest = a;
    square += away[a] > 0 ? away[a] * away[a] : 0;
  }
  const double outside = sqrt(square);
  for (int a = 0; a < count; a++) {
    const double size = away[nearest] > 0 ? pl_fmax(away[a], 0) / outside : a == nearest;
    out[a] = x[a] < 0 ? -size : size;
  }
  return away[nearest] > 0 ? outside : away[nearest];
}

static void put_together(const surface *s, const double parts[3], double out[3]) {
  for (int c = 0; c < 3; c++)
    out[c] = parts[0] * s->axes[0][c] + parts[1] * s->axes[1][c] + parts[2] * s->axes[2][c];
}

static double from_ball(const surface *s, const double from[3], double out[3]) {
  const double size = size_of(from);
  for (int c = 0; c < 3; c++)
    out[c] = size > 0 ? from[c] / size : c == 0;
  return size - s->half[0];
}

/* Along the axis and across it it is a rectangle. */
static double from_cylinder(const surface *s, const double x[3], double out[3]) {
  const double across = pl_hypot(x[1], x[2]), at[2] = {x[0], across};
  double parts[3], of[2];
  const double distance = from_box(at, s->half, 2, of);
  parts[0] = of[0];
  parts[1] = across > 0 ? of[1] * x[1] / across : of[1];
  parts[2] = across > 0 ? of[1] * x[2] / across : 0;
  put_together(s, parts, out);
  return distance;
}

double surface_distance(const surface *s, const double p[3], double out[3]) {
  double from[3], x[3], parts[3];
  for (int c = 0; c < 3; c++)
    from[c] = p[c] - s->centre[c];
  if (s->kind == SURFACE_BALL) return from_ball(s, from, out);
  for (int a = 0; a < 3; a++)
    x[a] = dot(from, s->axes[a]);
  if (s->kind == SURFACE_CYLINDER) return from_cylinder(s, x, out);
  const double distance = from_box(x, s->half, 3, parts);
  put_together(s, parts, out);
  return distance;
}

int surface_outline(const surface *s, double points[SURFACE_OUTLINE][2]) {
  static const int sides[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const int count = s->kind == SURFACE_BOX ? 4 : SURFACE_OUTLINE;
  for (int k = 0; k < count; k++) {
    const double angle = 2 * M_PI * k / count;
    const double a = s->kind == SURFACE_BOX ? s->half[0] * sides[k % 4][0]
                                            : s->half[0] * pl_cos(angle),
                 b = s->kind == SURFACE_BOX ? s->half[1] * sides[k % 4][1]
                                            : s->half[0] * pl_sin(angle);
    for (int c = 0; c < 2; c++)
      points[k][c] = s->centre[c] + a * s->axes[0][c] + b * s->axes[1][c];
  }
  return count;
}

/* Steiner: of a convex body A + c out + 4 pi out^2, in the plane L + 2 pi out. */
double surface_extent(const surface *s, int dimensions, double out) {
  const double *h = s->half, round = 4 * M_PI * out * out;
  if (s->kind == SURFACE_BALL)
    return dimensions == 2 ? 2 * M_PI * (h[0] + out) : 4 * M_PI * (h[0] + out) * (h[0] + out);
  if (s->kind == SURFACE_CYLINDER)
    return 2 * M_PI * h[1] * (2 * h[0] + h[1]) + 2 * M_PI * (2 * h[0] + M_PI * h[1]) * out + round;
  if (dimensions == 2) return 4 * (h[0] + h[1]) + 2 * M_PI * out;
  return 8 * (h[0] * h[1] + h[1] * h[2] + h[2] * h[0]) + 4 * M_PI * (h[0] + h[1] + h[2]) * out +
         round;
}
