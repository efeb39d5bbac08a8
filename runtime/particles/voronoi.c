#include "runtime/particles/voronoi.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/geometry/bins.h"

#define FIRST_REACH 2.5  /* spacings: half the side of the box that a cell begins with */
#define BOX_SIZE    1.0  /* spacings: of the boxes that points are sorted into */
#define ON_SIDE     1e-9 /* of the reach: a point so near to a side of the bodies' box lies on it */
enum { FEW = 48 };       /* points: no more than these are sorted by insertion */

/* --- boxes around a box, nearest first -------------------------------------------------------- */

typedef struct around {
  int step[3];
  double distance; /* least of points in the two boxes, in boxes */
} around;

static int nearer(const void *p, const void *q) {
  const around *a = p, *b = q;
  if (a->distance != b->distance) return a->distance < b->distance ? -1 : 1;
  for (int c = 0; c < 3; c++)
    if (a->step[c] != b->step[c]) return a->step[c] < b->step[c] ? -1 : 1;
  return 0;
}

static double gap(const int step[3]) {
  double square = 0;
  for (int c = 0; c < 3; c++) {
    const int between = abs(step[c]) - 1;
    if (between > 0) square += (double)between * between;
  }
  return sqrt(square);
}

typedef struct vicinity {
  around *boxes;
  long count;
} vicinity;

static int least(int a, int b) {
  return a < b ? a : b;
}

/* All boxes that a point `reach` boxes away may lie in. */
static vicinity vicinity_of(const boxes *b, double reach) {
  int most[3];
  long count = 1;
  for (int c = 0; c < 3; c++) {
    most[c] = least((int)pl_fmin(ceil(reach) + 1, 1e6), b->count[c] - 1);
    count *= 2 * most[c] + 1;
  }
  vicinity v = {.boxes = must_alloc((size_t)count * sizeof *v.boxes)};
  for (int z = -most[2]; z <= most[2]; z++)
    for (int y = -most[1]; y <= most[1]; y++)
      for (int x = -most[0]; x <= most[0]; x++) {
        around *a = &v.boxes[v.count];
        *a = (around){.step = {x, y, z}};
        a->distance = gap(a->step);
        if (a->distance <= reach) v.count++;
      }
  qsort(v.boxes, (size_t)v.count, sizeof *v.boxes, nearer);
  return v;
}

/* --- one cell --------------------------------------------------------------------------------- */

typedef struct candidate {
  double to[3], square;
  long point;
} candidate;

typedef struct cutter { /* of one thread */
  cell cell;
  solid_workspace scratch;
  candidate *list;
  int count, room;
} cutter;

static void place_of(const voronoi_points *p, long k, double at[3]) {
  at[2] = 0;
  for (int c = 0; c < p->dimensions; c++)
    at[c] = p->at[c][k];
}

/* Unless the plane half way to it passes by the cell. */
static void add_candidate(cutter *w, const voronoi_points *p, long k, const double at[3]) {
  if (w->count == w->room) {
    w->room = 2 * w->room + 64;
    w->list = must_realloc(w->list, (size_t)w->room * sizeof *w->list);
  }
  candidate *c = &w->list[w->count];
  place_of(p, k, c->to);
  c->point = k;
  c->square = 0;
  for (int d = 0; d < 3; d++) {
    c->to[d] -= at[d];
    c->square += c->to[d] * c->to[d];
  }
  if (c->square < 4 * w->cell.reach * w->cell.reach) w->count++;
}

static int nearest_first(const void *p, const void *q) {
  const candidate *a = p, *b = q;
  if (a->square != b->square) return a->square < b->square ? -1 : 1;
  return (a->point > b->point) - (a->point < b->point);
}

/* The same order as nearest_first gives; short lists, as nearly all are, in less time. */
static void sort_candidates(candidate *list, int count) {
  if (count > FEW) {
    qsort(list, (size_t)count, sizeof *list, nearest_first);
    return;
  }
  for (int k = 1; k < count; k++) {
    const candidate c = list[k];
    int m = k;
    for (; m > 0 && nearest_first(&c, &list[m - 1]) < 0; m--)
      list[m] = list[m - 1];
    list[m] = c;
  }
}

static void cut_by_candidates(cutter *w) {
  sort_candidates(w->list, w->count);
  for (int k = 0; k < w->count; k++) {
    const candidate *c = &w->list[k];
    if (c->square >= 4 * w->cell.reach * w->cell.reach) break;
    cell_cut(&w->cell, c->to, 0.5 * c->square);
  }
  w->count = 0;
}

/* Boxes of one distance are taken together. */
static void cut_by_neighbours(cutter *w, const voronoi_points *p, const bins *b, const vicinity *v,
                              long k, const double at[3]) {
  int home[3];
  boxes_home(&b->boxes, at, home);
  for (long n = 0; n < v->count;) {
    const double distance = v->boxes[n].distance;
    if (distance * b->boxes.size >= 2 * w->cell.reach) return;
    for (; n < v->count && v->boxes[n].distance == distance; n++) {
      const int *step = v->boxes[n].step;
      const int box[3] = {home[0] + step[0], home[1] + step[1], home[2] + step[2]};
      const int64_t number = boxes_number(&b->boxes, box);
      if (number < 0) continue;
      for (int32_t m = b->first[number]; m < b->first[number + 1]; m++)
        if (b->point[m] != k) add_candidate(w, p, b->point[m], at);
    }
    cut_by_candidates(w);
  }
}

/* The box about the point, within that of the bodies where the point is in there or, up to
   rounding, on its side. */
static void begin_cell(cutter *w, const solid *s, const double at[3], double reach) {
  double lower[3] = {0, 0, 0}, upper[3] = {0, 0, 0};
  for (int c = 0; c < s->dimensions; c++) {
    lower[c] = -reach;
    upper[c] = reach;
    const double below = s->lower[c] - at[c], above = s->upper[c] - at[c];
    if (below < ON_SIDE * reach) lower[c] = pl_fmax(lower[c], pl_fmin(below, 0));
    if (above > -ON_SIDE * reach) upper[c] = pl_fmin(upper[c], pl_fmax(above, 0));
  }
  cell_set_box(&w->cell, lower, upper);
}

/* Side of the box that the cell was begun with, 2 c for the lower one along axis c, 2 c + 1 for the
   upper, on which all these points lie; -1 when there is none. Sides that were drawn in to the
   bodies' box do not count. */
static int side_of(const cell *c, const int *points, int count, double reach) {
  for (int side = 0; side < 2 * c->dimensions; side++) {
    const double sign = side % 2 ? 1 : -1;
    int on = 0;
    while (on < count && sign * c->now.point[points[on]][side / 2] >= reach)
      on++;
    if (on == count) return side;
  }
  return -1;
}

static bool line_is_filled(cutter *w, const double at[3], const double *p, const double *q) {
  const double a[3] = {at[0] + p[0], at[1] + p[1], at[2] + p[2]};
  const double b[3] = {at[0] + q[0], at[1] + q[1], at[2] + q[2]};
  return solid_meets(&w->scratch, a, b);
}

/* Lines to the corners from their mean, and from corner to corner. */
static bool face_is_filled(cutter *w, const double at[3], const int *points, int count) {
  double mean[3] = {0, 0, 0};
  for (int k = 0; k < count; k++)
    for (int c = 0; c < 3; c++)
      mean[c] += w->cell.now.point[points[k]][c] / count;
  for (int k = 0; k < count; k++) {
    const double *p = w->cell.now.point[points[k]];
    const double *q = w->cell.now.point[points[k + 1 < count ? k + 1 : 0]];
    if (line_is_filled(w, at, mean, p) || line_is_filled(w, at, p, q)) return true;
  }
  return false;
}

/* The cell ends inside the body at a side of the box that it was begun with: more belongs to it. */
static bool is_open(cutter *w, const double at[3], double reach) {
  const cell_part *part = &w->cell.now;
  if (w->cell.reach < reach) return false;
  for (int k = 0; w->cell.dimensions == 2 && k < part->point_count; k++) {
    const int ends[2] = {k, k + 1 < part->point_count ? k + 1 : 0};
    if (side_of(&w->cell, ends, 2, reach) >= 0 &&
        line_is_filled(w, at, part->point[ends[0]], part->point[ends[1]]))
      return true;
  }
  for (int f = 0; f < part->face_count; f++) {
    const int *points = part->corner + part->face[f], count = part->face[f + 1] - part->face[f];
    if (side_of(&w->cell, points, count, reach) >= 0 && face_is_filled(w, at, points, count))
      return true;
  }
  return false;
}

/* --- all cells -------------------------------------------------------------------------------- */

typedef struct diagram {
  const voronoi_points *points;
  const solid *solid;
  bins bins;
  vicinity vicinity;
  double reach;     /* spacings */
  double tolerance; /* of a cell */
  double *volume;
  double *const *centroid;
  bool *open;
} diagram;

static void measure_cell(const diagram *g, cutter *w, long k) {
  const double reach = g->reach * (g->points->own ? g->points->own[k] : g->points->spacing);
  double at[3];
  place_of(g->points, k, at);
  begin_cell(w, g->solid, at, reach);
  cut_by_neighbours(w, g->points, &g->bins, &g->vicinity, k, at);
  const cell_moments m = solid_fill(g->solid, &w->scratch, &w->cell, at, g->tolerance);
  g->volume[k] = m.size;
  g->open[k] = is_open(w, at, reach);
  for (int c = 0; g->centroid && c < g->points->dimensions; c++)
    g->centroid[c][k] = m.size > 0 ? at[c] + m.first[c] / m.size : at[c];
}

static void measure_open_cells(const diagram *g) {
#pragma omp parallel
  {
    cutter w = {.room = 0};
    cell_begin(&w.cell, g->points->dimensions);
    solid_workspace_begin(&w.scratch, g->solid);
#pragma omp for schedule(dynamic, 64)
    for (long n = 0; n < g->points->count; n++) {
      const long k = g->bins.point[n]; /* neighbours one after the other: their data is at hand */
      if (g->open[k]) measure_cell(g, &w, k);
    }
    solid_workspace_end(&w.scratch);
    cell_end(&w.cell);
    free(w.list);
  }
}

static bool any_open(const diagram *g) {
  for (long k = 0; k < g->points->count; k++)
    if (g->open[k]) return true;
  return false;
}

/* Farther than this from each other are no two places of the body and the points. */
static double farthest(const diagram *g) {
  double square = 0;
  for (int c = 0; c < g->points->dimensions; c++) {
    double low = g->solid->lower[c], high = g->solid->upper[c];
    for (long k = 0; k < g->points->count; k++) {
      low = pl_fmin(low, g->points->at[c][k]);
      high = pl_fmax(high, g->points->at[c][k]);
    }
    square += (high - low) * (high - low);
  }
  return sqrt(square);
}

static double largest_spacing(const voronoi_points *p) {
  double largest = p->spacing;
  for (long k = 0; p->own && k < p->count; k++)
    largest = pl_fmax(largest, p->own[k]);
  return largest;
}

void voronoi_measure(const voronoi_points *p, const solid *s, double tolerance, double *volume,
                     double *const centroid[3]) {
  diagram g = {p, s, .tolerance = tolerance, .volume = volume, .centroid = centroid};
  if (p->count == 0) return;
  bins_of_size(&g.bins, p->dimensions, (const double *const *)p->at, p->count,
               BOX_SIZE * p->spacing);
  g.open = must_alloc((size_t)p->count * sizeof *g.open);
  memset(g.open, true, (size_t)p->count * sizeof *g.open);
  const double all = farthest(&g), largest = largest_spacing(p);
  for (g.reach = FIRST_REACH;; g.reach *= 2) {
    g.vicinity =
        vicinity_of(&g.bins.boxes, 2 * g.reach * largest * sqrt(p->dimensions) / g.bins.boxes.size);
    measure_open_cells(&g);
    free(g.vicinity.boxes);
    if (g.reach * p->spacing >= all || !any_open(&g)) break;
  }
  free(g.open);
  bins_end(&g.bins);
}

/* --- distances -------------------------------------------------------------------------------- */

static long near_partner(const voronoi_points *p, const bins *b, long k, double distance) {
  double at[3], other[3];
  int home[3];
  long found = -1;
  place_of(p, k, at);
  boxes_home(&b->boxes, at, home);
  for (int n = 0; n < (p->dimensions == 3 ? 27 : 9); n++) {
    const int box[3] = {home[0] + n % 3 - 1, home[1] + n / 3 % 3 - 1,
                        home[2] + (p->dimensions == 3 ? n / 9 - 1 : 0)};
    const int64_t number = boxes_number(&b->boxes, box);
    if (number < 0) continue;
    for (int32_t i = b->first[number]; i < b->first[number + 1]; i++) {
      const long m = b->point[i];
      place_of(p, m, other);
      if (m > k && (found < 0 || m < found) &&
          pl_hypot(pl_hypot(other[0] - at[0], other[1] - at[1]), other[2] - at[2]) < distance)
        found = m;
    }
  }
  return found;
}

bool voronoi_too_near(const voronoi_points *p, double distance, long pair[2]) {
  bins b;
  bins_of_size(&b, p->dimensions, (const double *const *)p->at, p->count, distance);
  pair[1] = -1;
  for (pair[0] = 0; pair[0] < p->count; pair[0]++) {
    pair[1] = near_partner(p, &b, pair[0], distance);
    if (pair[1] >= 0) break;
  }
  bins_end(&b);
  return pair[1] >= 0;
}
