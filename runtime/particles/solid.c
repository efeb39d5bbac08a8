#include "runtime/particles/solid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/geometry/shape.h"
#include "runtime/particles/site_marks.h"

enum {
  MOST_HALVINGS = 40,
  MOST_QUARTERINGS = 6,
  FEW_SHAPES = 6,
  MOST_SPLITS = 15,
  ALWAYS_SPLIT_TO = 6
};

#define ROUGH      1e-3 /* tolerance of cells whose volumes are not kept */
#define ON_SURFACE 1e-9 /* of the reach of a cell: a point nearer to a surface may lie outside */

/* --- the set ---------------------------------------------------------------------------------- */

static void widen(solid *s, const deck_shape *shape) {
  double lower[3], upper[3];
  shape_box(shape, lower, upper);
  for (int c = 0; c < 3; c++) {
    s->lower[c] = pl_fmin(s->lower[c], lower[c]);
    s->upper[c] = pl_fmax(s->upper[c], upper[c]);
  }
}

void solid_begin(solid *s, const deck *k, int lattice) {
  const deck_lattice *l = &k->lattices[lattice];
  *s = (solid){.dimensions = deck_lattice_dimensions(l),
               .bodies = must_calloc((size_t)k->body_count + 1, sizeof *s->bodies),
               .notches = must_calloc((size_t)k->notch_count + 1, sizeof *s->notches),
               .lower = {INFINITY, INFINITY, INFINITY},
               .upper = {-INFINITY, -INFINITY, -INFINITY}};
  for (int n = 0; n < k->body_count; n++) {
    if (!site_of_lattice(l, k->bodys[n].lattice) || !shape_has_size(&k->bodys[n].shape)) continue;
    s->bodies[s->body_count++] = &k->bodys[n].shape;
    widen(s, &k->bodys[n].shape);
  }
  for (int n = 0; n < k->notch_count; n++)
    if (site_of_lattice(l, k->notchs[n].lattice) && shape_has_size(&k->notchs[n].shape))
      s->notches[s->notch_count++] = &k->notchs[n].shape;
}

void solid_end(solid *s) {
  free(s->bodies);
  free(s->notches);
}

static bool any_holds(const deck_shape *const *shapes, int count, const double *at) {
  for (int n = 0; n < count; n++)
    if (shape_contains(shapes[n], at, 0)) return true;
  return false;
}

bool solid_holds(const solid *s, const double at[3]) {
  return any_holds(s->bodies, s->body_count, at) && !any_holds(s->notches, s->notch_count, at);
}

/* --- the workspace ---------------------------------------------------------------------------- */

void solid_workspace_begin(solid_workspace *w, const solid *s) {
  *w = (solid_workspace){.cut_room = 64, .level_room = 64};
  w->near.dimensions = s->dimensions;
  w->near.bodies = must_calloc((size_t)s->body_count + 1, sizeof *w->near.bodies);
  w->near.notches = must_calloc((size_t)s->notch_count + 1, sizeof *w->near.notches);
  w->cuts = must_alloc(64 * sizeof *w->cuts);
  w->levels = must_alloc(64 * sizeof *w->levels);
}

void solid_workspace_end(solid_workspace *w) {
  solid_end(&w->near);
  free(w->cuts);
  free(w->levels);
}

static int near_ones(const deck_shape *const *shapes, int count, const double *at, double reach,
                     const deck_shape **near) {
  int found = 0;
  for (int n = 0; n < count; n++)
    if (shape_contains(shapes[n], at, reach)) near[found++] = shapes[n];
  return found;
}

/* Shapes that come within `reach` of the place. */
static void find_near(const solid *s, solid_workspace *w, const double *at, double reach) {
  w->near.body_count = near_ones(s->bodies, s->body_count, at, reach, w->near.bodies);
  w->near.notch_count = near_ones(s->notches, s->notch_count, at, reach, w->near.notches);
}

/* --- pieces of lines -------------------------------------------------------------------------- */

static void add_cuts(solid_workspace *w, const deck_shape *shape, const double *a,
                     const double *b) {
  int found = shape_cuts(shape, a, b, w->cuts + w->cut_count, w->cut_room - w->cut_count - 1);
  if (w->cut_count + found + 1 > w->cut_room) {
    w->cut_room = 2 * (w->cut_count + found + 1);
    w->cuts = must_realloc(w->cuts, (size_t)w->cut_room * sizeof *w->cuts);
    found = shape_cuts(shape, a, b, w->cuts + w->cut_count, w->cut_room - w->cut_count - 1);
  }
  w->cut_count += found;
}

static void sort_numbers(double *x, int count) {
  for (int k = 1; k < count; k++) {
    const double value = x[k];
    int m = k;
    for (; m > 0 && x[m - 1] > value; m--)
      x[m] = x[m - 1];
    x[m] = value;
  }
}

/* Places, 0 < u < 1, where the line from a to b may enter or leave a near shape. */
static void find_cuts(solid_workspace *w, const double *a, const double *b) {
  w->cut_count = 0;
  for (int n = 0; n < w->near.body_count; n++)
    add_cuts(w, w->near.bodies[n], a, b);
  for (int n = 0; n < w->near.notch_count; n++)
    add_cuts(w, w->near.notches[n], a, b);
}

/* Sums of u1^n - u0^n over the pieces u0 < u < u1 of the line a-b that lie in the near shapes, for
   n = power and n = power + 1. */
static void fill_line(solid_workspace *w, const double *a, const double *b, int power,
                      double sum[2]) {
  find_cuts(w, a, b);
  if (power == 3 && w->leaves_once) {
    double u = 1;
    for (int k = 0; k < w->cut_count; k++)
      u = pl_fmin(u, w->cuts[k]);
    sum[0] = u * u * u;
    sum[1] = sum[0] * u;
    return;
  }
  sort_numbers(w->cuts, w->cut_count);
  w->cuts[w->cut_count] = 1;
  sum[0] = sum[1] = 0;
  double from = 0;
  for (int k = 0; k <= w->cut_count; k++) {
    const double to = w->cuts[k], u = 0.5 * (from + to);
    const double at[3] = {a[0] + u * (b[0] - a[0]), a[1] + u * (b[1] - a[1]),
                          a[2] + u * (b[2] - a[2])};
    if (to > from && solid_holds(&w->near, at)) {
      const double low = power == 3 ? from * from * from : from;
      const double high = power == 3 ? to * to * to : to;
      sum[0] += high - low;
      sum[1] += high * to - low * from;
    }
    from = to;
  }
}

bool solid_meets(solid_workspace *w, const double a[3], const double b[3]) {
  double sum[2];
  if (w->near.body_count == 0) return false;
  fill_line(w, a, b, 1, sum);
  return sum[0] > 0;
}

/* A cell that is being measured. */
typedef struct filling {
  solid_workspace *scratch;
  const cell *cell;
  const double *at;
  double tolerance; /* m^2, m^3 */
  bool roughly;     /* a triangle all of whose rays are whole is not looked at again */
} filling;

static void add_scaled(cell_moments *sum, double factor, const cell_moments *m) {
  sum->size += factor * m->size;
  for (int c = 0; c < 3; c++)
    sum->first[c] += factor * m->first[c];
}

static bool agree(const filling *f, const cell_moments *a, const cell_moments *b) {
  bool close = fabs(a->size - b->size) <= f->tolerance;
  for (int c = 0; c < 3; c++)
    close &= fabs(a->first[c] - b->first[c]) <= f->tolerance * f->cell->reach;
  return close;
}

/* --- in the plane: along lines y = const ------------------------------------------------------ */

static const double *corner(const filling *f, int k) {
  return f->cell->now.point[k < f->cell->now.point_count ? k : 0];
}

/* Where a line y = const enters and leaves the cell. */
static bool ends_of_line(const filling *f, double y, double *low, double *high) {
  *low = INFINITY;
  *high = -INFINITY;
  for (int k = 0; k < f->cell->now.point_count; k++) {
    const double *a = corner(f, k), *b = corner(f, k + 1);
    if ((a[1] <= y) == (b[1] <= y)) continue;
    const double x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    *low = pl_fmin(*low, x);
    *high = pl_fmax(*high, x);
  }
  return *high > *low;
}

static cell_moments across(const filling *f, double y) {
  double low, high, sum[2];
  if (!ends_of_line(f, y, &low, &high)) return (cell_moments){0};
  const double a[3] = {f->at[0] + low, f->at[1] + y, 0}, b[3] = {f->at[0] + high, a[1], 0};
  const double whole = high - low;
  fill_line(f->scratch, a, b, 1, sum);
  const double length = sum[0] * whole;
  return (cell_moments){length, {low * length + 0.5 * whole * whole * sum[1], y * length, 0}};
}

/* Gauss's rule of three points, exact to the fifth power. It never asks at the ends, where lengths
   may jump. */
static cell_moments gauss(const filling *f, double low, double high) {
  static const double node[3] = {-0.77459666924148337704, 0, 0.77459666924148337704};
  static const double weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  cell_moments sum = {0};
  for (int k = 0; k < 3; k++) {
    const cell_moments m = across(f, 0.5 * (low + high) + 0.5 * (high - low) * node[k]);
    add_scaled(&sum, weight[k] * (high - low), &m);
  }
  return sum;
}

static cell_moments halve(const filling *f, double low, double high, cell_moments whole,
                          int halvings) {
  const double middle = 0.5 * (low + high);
  const cell_moments left = gauss(f, low, middle), right = gauss(f, middle, high);
  cell_moments both = left;
  add_scaled(&both, 1, &right);
  if (halvings == 0 || agree(f, &both, &whole)) return both;
  both = halve(f, low, middle, left, halvings - 1);
  const cell_moments rest = halve(f, middle, high, right, halvings - 1);
  add_scaled(&both, 1, &rest);
  return both;
}

/* --- levels: where the length of a line may jump or bend -------------------------------------- */

static void need_levels(solid_workspace *w, int more) {
  if (w->level_count + more <= w->level_room) return;
  w->level_room = 2 * (w->level_count + more);
  w->levels = must_realloc(w->levels, (size_t)w->level_room * sizeof *w->levels);
}

static void add_levels_of_shape(const filling *f, const deck_shape *shape) {
  solid_workspace *w = f->scratch;
  const int count = shape_levels(shape, 1, NULL, 0);
  need_levels(w, count);
  shape_levels(shape, 1, w->levels + w->level_count, count);
  for (int k = 0; k < count; k++)
    w->levels[w->level_count++] -= f->at[1];
}

/* Those of the cell's corners and of its sides' crossings with surfaces. */
static void add_levels_of_cell(const filling *f) {
  solid_workspace *w = f->scratch;
  for (int k = 0; k < f->cell->now.point_count; k++) {
    const double *p = corner(f, k), *q = corner(f, k + 1);
    const double a[3] = {f->at[0] + p[0], f->at[1] + p[1], 0};
    const double b[3] = {f->at[0] + q[0], f->at[1] + q[1], 0};
    find_cuts(w, a, b);
    need_levels(w, w->cut_count + 1);
    w->levels[w->level_count++] = p[1];
    for (int m = 0; m < w->cut_count; m++)
      w->levels[w->level_count++] = p[1] + w->cuts[m] * (q[1] - p[1]);
  }
}

static cell_moments fill_polygon(const filling *f) {
  solid_workspace *w = f->scratch;
  double lower[3], upper[3];
  cell_moments sum = {0};
  cell_extent(f->cell, lower, upper);
  w->level_count = 0;
  add_levels_of_cell(f);
  for (int n = 0; n < w->near.body_count; n++)
    add_levels_of_shape(f, w->near.bodies[n]);
  for (int n = 0; n < w->near.notch_count; n++)
    add_levels_of_shape(f, w->near.notches[n]);
  sort_numbers(w->levels, w->level_count);
  for (int k = 0; k + 1 < w->level_count; k++) {
    const double low = pl_fmax(w->levels[k], lower[1]), high = pl_fmin(w->levels[k + 1], upper[1]);
    if (!(high > low)) continue;
    const cell_moments part = halve(f, low, high, gauss(f, low, high), MOST_HALVINGS);
    add_scaled(&sum, 1, &part);
  }
  return sum;
}

/* --- in space: along rays from the point to the faces ----------------------------------------- */

typedef struct beam { /* to a triangle */
  cell_moments filled;
  bool whole; /* no ray leaves the solid */
} beam;

/* The rays to a triangle of a face, corners seen from the point: what of their tetrahedron is
   filled, by the rule of three points that is exact to the second power (Strang and Fix 1973). */
static beam rays(const filling *f, const double corners[3][3]) {
  const double *p = corners[0], *q = corners[1], *r = corners[2];
  const double volume = (p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) +
                         p[2] * (q[0] * r[1] - q[1] * r[0])) /
                        6;
  beam b = {.whole = true};
  for (int k = 0; k < 3; k++) {
    double to[3], end[3], sum[2];
    for (int c = 0; c < 3; c++) {
      to[c] = (p[c] + q[c] + r[c] + 3 * corners[k][c]) / 6;
      end[c] = f->at[c] + to[c];
    }
    fill_line(f->scratch, f->at, end, 3, sum);
    b.whole &= sum[0] > 1 - 1e-9;
    b.filled.size += volume * sum[0] / 3;
    for (int c = 0; c < 3; c++)
      b.filled.first[c] += 0.75 * to[c] * volume * sum[1] / 3;
  }
  return b;
}

/* Corner triangles and the middle one of a triangle halved at its sides. */
static void quarter(const double corners[3][3], double parts[4][3][3]) {
  for (int c = 0; c < 3; c++)
    for (int k = 0; k < 3; k++) {
      const double a = corners[k][c], b = corners[(k + 1) % 3][c], middle = 0.5 * (a + b);
      parts[k][0][c] = a;
      parts[k][1][c] = parts[(k + 1) % 3][2][c] = parts[3][k][c] = middle;
    }
}

static cell_moments refine(const filling *f, const double corners[3][3], const beam *first,
                           int quarterings) {
  double parts[4][3][3];
  beam part[4];
  cell_moments sum = {0};
  if (quarterings == 0 || (first->whole && f->roughly)) return first->filled;
  quarter(corners, parts);
  for (int k = 0; k < 4; k++) {
    part[k] = rays(f, parts[k]);
    add_scaled(&sum, 1, &part[k].filled);
  }
  if (agree(f, &sum, &first->filled)) return sum;
  sum = (cell_moments){0};
  for (int k = 0; k < 4; k++) {
    const cell_moments m = refine(f, parts[k], &part[k], quarterings - 1);
    add_scaled(&sum, 1, &m);
  }
  return sum;
}

static cell_moments fill_polyhedron(const filling *f) {
  const cell_part *p = &f->cell->now;
  const solid *near = &f->scratch->near;
  f->scratch->leaves_once = near->body_count == 1 && near->notch_count == 0 &&
                            shape_is_convex(near->bodies[0]) &&
                            shape_contains(near->bodies[0], f->at, -ON_SURFACE * f->cell->reach);
  cell_moments sum = {0};
  for (int face = 0; face < p->face_count; face++)
    for (int k = p->face[face] + 1; k + 1 < p->face[face + 1]; k++) {
      const int ends[3] = {p->corner[p->face[face]], p->corner[k], p->corner[k + 1]};
      double corners[3][3];
      for (int c = 0; c < 3; c++)
        memcpy(corners[c], p->point[ends[c]], sizeof corners[c]);
      const beam first = rays(f, corners);
      const cell_moments part = refine(f, corners, &first, MOST_QUARTERINGS);
      add_scaled(&sum, 1, &part);
    }
  return sum;
}

/* --- cells ------------------------------------------------------------------------------------ */

/* A convex body that holds all corners holds the cell; so does one that holds the ball about it. */
static bool body_holds(const deck_shape *shape, const cell *c, const double *at) {
  if (shape_contains(shape, at, -c->reach)) return true;
  if (!shape_is_convex(shape)) return false;
  for (int k = 0; k < c->now.point_count; k++) {
    const double *q = c->now.point[k];
    const double corner[3] = {at[0] + q[0], at[1] + q[1], at[2] + q[2]};
    if (!shape_contains(shape, corner, 1e-9 * c->reach)) return false;
  }
  return true;
}

static bool lies_inside(const solid *near, const cell *c, const double *at) {
  for (int n = 0; near->notch_count == 0 && n < near->body_count; n++)
    if (body_holds(near->bodies[n], c, at)) return true;
  return false;
}

cell_moments solid_fill(const solid *s, solid_workspace *w, const cell *c, const double at[3],
                        double tolerance) {
  find_near(s, w, at, c->reach);
  const cell_moments whole = cell_measure(c);
  if (w->near.body_count == 0) return (cell_moments){0};
  if (lies_inside(&w->near, c, at)) return whole;
  const filling f = {w, c, at, tolerance * whole.size, tolerance >= ROUGH};
  return s->dimensions == 2 ? fill_polygon(&f) : fill_polyhedron(&f);
}

/* --- the whole -------------------------------------------------------------------------------- */

/* Boxes are halved across their longest side: parts are even, and have fewer shapes. */
static double size_in_box(const solid *s, solid_workspace *w, cell *c, const double lower[3],
                          const double upper[3], double tolerance, int splits) {
  double at[3] = {0, 0, 0}, below[3] = {0, 0, 0}, above[3] = {0, 0, 0};
  int longest = 0;
  for (int d = 0; d < s->dimensions; d++) {
    at[d] = 0.5 * (lower[d] + upper[d]);
    below[d] = lower[d] - at[d];
    above[d] = upper[d] - at[d];
    if (above[d] > above[longest]) longest = d;
  }
  cell_set_box(c, below, above);
  find_near(s, w, at, c->reach);
  if ((splits <= ALWAYS_SPLIT_TO && w->near.body_count + w->near.notch_count <= FEW_SHAPES) ||
      splits == 0)
    return solid_fill(s, w, c, at, tolerance).size;
  double middle[3] = {lower[0], lower[1], lower[2]}, end[3] = {upper[0], upper[1], upper[2]};
  middle[longest] = end[longest] = at[longest];
  return size_in_box(s, w, c, lower, end, tolerance, splits - 1) +
         size_in_box(s, w, c, middle, upper, tolerance, splits - 1);
}

double solid_size(const solid *s, double tolerance) {
  if (s->body_count == 0) return 0;
  solid_workspace w;
  cell c;
  solid_workspace_begin(&w, s);
  cell_begin(&c, s->dimensions);
  const double size = size_in_box(s, &w, &c, s->lower, s->upper, tolerance, MOST_SPLITS);
  cell_end(&c);
  solid_workspace_end(&w);
  return size;
}
