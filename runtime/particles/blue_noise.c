#include "runtime/particles/blue_noise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/random_number.h"
#include "runtime/geometry/bins.h"
#include "runtime/geometry/shape.h"

/* Darts saturate at 0.78 of the hexagonal and 0.80 of the fcc spacing. Those at a larger distance
   first spare gaps later. */
#define FIRST_DISTANCE 0.85 /* spacings */
#define DISTANCE_FALLS 0.98 /* by this factor after so many misses: */
enum { MISSES = 50 };

/* The standard deviation of the volumes falls from 0.21 of the mean (in space 0.25) to 0.11 (0.12)
   in 5 steps, to 0.09 (0.10) in 10, to 0.08 (0.08) in 20: further steps cost as much and gain less,
   and let the particles freeze into grains of a lattice. */
enum { LLOYD_STEPS = 10 };
static const double lloyd_tolerance[] = {[2] = 1e-3, [3] = 1e-2}; /* of a cell */

/* --- darts ------------------------------------------------------------------------------------ */

typedef struct board {
  const solid *solid;
  const gradation *sizes;
  double *share;        /* [bodies] of boxes of bodies up to this one in the volume of all boxes */
  boxes boxes;          /* as large as the first distance of the smallest particles, or larger */
  int32_t *head, *next; /* first point of each box, the next of each point, or -1 */
  uint64_t seed, thrown;
} board;

static void find_shares(board *b) {
  const solid *s = b->solid;
  double sum = 0;
  b->share = must_alloc((size_t)s->body_count * sizeof *b->share);
  for (int n = 0; n < s->body_count; n++) {
    double lower[3], upper[3], volume = 1;
    shape_box(s->bodies[n], lower, upper);
    for (int c = 0; c < s->dimensions; c++)
      volume *= upper[c] - lower[c];
    b->share[n] = sum += volume;
  }
  for (int n = 0; n < s->body_count; n++)
    b->share[n] /= sum;
}

static void board_begin(board *b, const solid *s, const gradation *g, long points, uint64_t seed) {
  const double size = FIRST_DISTANCE * g->least;
  *b = (board){.solid = s,
               .sizes = g,
               .boxes = {.dimensions = s->dimensions, .size = size, .count = {1, 1, 1}},
               .seed = random_mix(seed)};
  for (int c = 0; c < s->dimensions; c++) {
    b->boxes.lower[c] = s->lower[c];
    b->boxes.count[c] = (int)((s->upper[c] - s->lower[c]) / size) + 1;
  }
  const size_t bytes = (size_t)boxes_all(&b->boxes) * sizeof *b->head;
  b->head = memset(must_alloc(bytes), 0xff, bytes);
  b->next = must_alloc((size_t)points * sizeof *b->next);
  find_shares(b);
}

static void board_end(board *b) {
  free(b->share);
  free(b->head);
  free(b->next);
}

static double draw(board *b) {
  return random_unit(random_mix(b->seed + random_mix(b->thrown++)));
}

/* Anywhere in the body with the same probability: where bodies overlap the first takes the dart. */
static bool throw_dart(board *b, double at[3]) {
  const solid *s = b->solid;
  const double which = draw(b);
  double lower[3], upper[3];
  int body = 0;
  while (body + 1 < s->body_count && which > b->share[body])
    body++;
  shape_box(s->bodies[body], lower, upper);
  at[2] = 0;
  for (int c = 0; c < s->dimensions; c++)
    at[c] = lower[c] + (upper[c] - lower[c]) * draw(b);
  for (int n = 0; n < body; n++)
    if (shape_contains(s->bodies[n], at, 0)) return false;
  return shape_contains(s->bodies[body], at, 0) && solid_holds(s, at);
}

/* The spacing where the dart has fallen; 0 where others have fallen as densely as particles are to
   stand there: so often that it is the density which counts. */
static double spacing_of_dart(board *b, const double at[3]) {
  const gradation *g = b->sizes;
  if (!g->graded) return g->spacing;
  const double spacing = pl_fmax(gradation_at(g, at), g->least), part = g->least / spacing;
  const double density = g->dimensions == 3 ? part * part * part : part * part;
  return draw(b) < density ? spacing : 0;
}

static bool is_near(const board *b, const voronoi_points *p, const int box[3], const double at[3],
                    double square) {
  const int64_t number = boxes_number(&b->boxes, box);
  for (int32_t k = number < 0 ? -1 : b->head[number]; k >= 0; k = b->next[k]) {
    double sum = 0;
    for (int c = 0; c < p->dimensions; c++)
      sum += (p->at[c][k] - at[c]) * (p->at[c][k] - at[c]);
    if (sum < square) return true;
  }
  return false;
}

static bool is_free(const board *b, const voronoi_points *p, const double at[3], double distance) {
  const int reach = (int)ceil(distance / b->boxes.size), layers = p->dimensions == 3 ? reach : 0;
  int home[3];
  boxes_home(&b->boxes, at, home);
  for (int z = -layers; z <= layers; z++)
    for (int y = -reach; y <= reach; y++)
      for (int x = -reach; x <= reach; x++) {
        const int box[3] = {home[0] + x, home[1] + y, home[2] + z};
        if (is_near(b, p, box, at, distance * distance)) return false;
      }
  return true;
}

static void put(board *b, voronoi_points *p, long k, const double at[3]) {
  int box[3];
  for (int c = 0; c < p->dimensions; c++)
    p->at[c][k] = at[c];
  boxes_home(&b->boxes, at, box);
  int32_t *head = &b->head[boxes_number(&b->boxes, box)];
  b->next[k] = *head;
  *head = (int32_t)k;
}

static void throw_all(voronoi_points *p, const solid *s, const gradation *g, uint64_t seed) {
  double distance = FIRST_DISTANCE, at[3]; /* spacings */
  board b;
  board_begin(&b, s, g, p->count, seed);
  int misses = 0;
  for (long k = 0; k < p->count;) {
    if (!throw_dart(&b, at)) continue;
    const double spacing = spacing_of_dart(&b, at);
    if (!(spacing > 0)) continue;
    if (is_free(&b, p, at, distance * spacing)) {
      put(&b, p, k++, at);
      misses = 0;
    } else if (++misses == MISSES) {
      distance *= DISTANCE_FALLS;
      misses = 0;
    }
  }
  board_end(&b);
}

/* --- Lloyd ------------------------------------------------------------------------------------ */

/* From the centroid of a cell to that of a mass in it of the density h^-(d + 2), in d dimensions: h
   is linear across the cell, and the cell a disc or ball of radius r, whose second moment is r^2/(d
   + 2) of its size. */
static void lean(const gradation *g, double volume, double at[3]) {
  if (!g->graded) return;
  const double r = g->dimensions == 2 ? sqrt(volume / M_PI) : pl_cbrt(0.75 * volume / M_PI);
  const double h = gradation_at(g, at);
  double slope[3];
  gradation_slope(g, at, r, slope);
  for (int c = 0; c < g->dimensions && h > 0; c++)
    at[c] -= r * r * slope[c] / h;
}

/* In a body that is not convex a centroid may lie outside: then the point stays. */
static void move(voronoi_points *p, const solid *s, const gradation *g, const double *volume,
                 double *const centroid[3]) {
  for (long k = 0; k < p->count; k++) {
    double at[3] = {0, 0, 0};
    for (int c = 0; c < p->dimensions; c++)
      at[c] = centroid[c][k];
    lean(g, volume[k], at);
    if (!solid_holds(s, at)) continue;
    for (int c = 0; c < p->dimensions; c++)
      p->at[c][k] = at[c];
  }
}

/* Bounded, whatever the formula says between the places where it was looked at. */
static void find_own(voronoi_points *p, const gradation *g) {
  for (long k = 0; p->own && k < p->count; k++) {
    double at[3] = {0, 0, 0};
    for (int c = 0; c < p->dimensions; c++)
      at[c] = p->at[c][k];
    p->own[k] =
        pl_fmin(pl_fmax(gradation_at(g, at), p->spacing), GRADATION_MOST_RATIO * p->spacing);
  }
}

void blue_noise_fill(voronoi_points *p, const solid *s, const gradation *g, uint64_t seed) {
  const size_t bytes = (size_t)p->count * sizeof(double);
  double *volume = must_alloc(bytes), *centroid[3] = {0};
  for (int c = 0; c < p->dimensions; c++)
    centroid[c] = must_alloc(bytes);
  throw_all(p, s, g, seed);
  find_own(p, g);
  for (int n = 0; n < LLOYD_STEPS; n++) {
    voronoi_measure(p, s, lloyd_tolerance[p->dimensions], volume, centroid);
    move(p, s, g, volume, centroid);
    find_own(p, g);
  }
  free(volume);
  for (int c = 0; c < p->dimensions; c++)
    free(centroid[c]);
}
