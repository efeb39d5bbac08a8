#include "runtime/lattice/bond_ways.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

#define ALIKE 1e-9 /* spacings: ways that differ by less are one */
#define APART 1e-3 /* spacings: lines that differ by less are one */

enum { FEWEST = 64, LOOK = 16384 };

/* --- ways of bonds ---------------------------------------------------------------------------- */

/* From i to j, turned so that it leads to higher z, else y, else x. Returns whether it is
   turned. */
static bool way_of(const point_cloud *p, const point_pair *pair, double least, double chord[3]) {
  int last = -1;
  for (int a = 0; a < 3; a++) {
    chord[a] = a < p->dimensions ? p->at[a][pair->j] - p->at[a][pair->i] : 0;
    if (fabs(chord[a]) > least) last = a;
  }
  if (last < 0 || chord[last] > 0) return false;
  for (int a = 0; a < 3; a++)
    chord[a] = -chord[a];
  return true;
}

static bool is_near(const double a[3], const double b[3], double least) {
  return fabs(a[0] - b[0]) <= least && fabs(a[1] - b[1]) <= least && fabs(a[2] - b[2]) <= least;
}

/* Bonds in the order of particles often go on with the way after the last one's. */
static int find_way(bond_ways *w, const double chord[3], double least, int after) {
  for (int k = 0; k < w->count; k++) {
    const int at = (after + k) % w->count;
    if (is_near(w->chord[at], chord, least)) return at;
  }
  if (w->count == BOND_WAYS_MOST) return -1;
  memcpy(w->chord[w->count], chord, sizeof w->chord[0]);
  return w->count++;
}

/* False as soon as it shows that most bonds have their own ways. */
static bool note_ways(const point_cloud *p, const point_pairs *pairs, double least, bond_ways *w) {
  long own = 0;
  for (long m = 0, last = 0; m < pairs->count; m++) {
    double chord[3];
    const bool turned = way_of(p, &pairs->items[m], least, chord);
    const int way = find_way(w, chord, least, (int)last + 1);
    w->of[m] = (int16_t)(turned ? -(way + 1) : way + 1);
    if (way < 0) own++;
    if (way >= 0) w->bonds[last = way]++;
    if (m % LOOK == LOOK - 1 && 2 * own > m) return false;
  }
  return 2 * own <= pairs->count;
}

typedef struct counted {
  long bonds;
  int way;
} counted;

static int by_bonds(const void *a, const void *b) {
  const counted *p = a, *q = b;
  if (p->bonds != q->bonds) return p->bonds > q->bonds ? -1 : 1;
  return p->way < q->way ? -1 : 1;
}

/* The most common first. Returns how many bonds go a common way. */
static long sort_ways(bond_ways *w, long particles, long pairs) {
  counted sorted[BOND_WAYS_MOST];
  double chord[BOND_WAYS_MOST][3];
  int place[BOND_WAYS_MOST];
  long common = 0;
  for (int k = 0; k < w->count; k++)
    sorted[k] = (counted){w->bonds[k], k};
  qsort(sorted, (size_t)w->count, sizeof *sorted, by_bonds);
  for (int k = 0; k < w->count; k++) {
    place[sorted[k].way] = k;
    w->bonds[k] = sorted[k].bonds;
    memcpy(chord[k], w->chord[sorted[k].way], sizeof chord[k]);
    if (k >= BOND_WAYS_MOST_COMMON || 4 * sorted[k].bonds < particles) continue;
    w->common = k + 1;
    common += sorted[k].bonds;
  }
  memcpy(w->chord, chord, (size_t)w->count * sizeof *chord);
  for (long m = 0; m < pairs; m++)
    w->of[m] = (int16_t)(w->of[m] > 0   ? place[w->of[m] - 1] + 1
                         : w->of[m] < 0 ? -(place[-w->of[m] - 1] + 1)
                                        : 0);
  return common;
}

bool bond_ways_find(const point_cloud *points, const point_pairs *pairs, double spacing,
                    bond_ways *w) {
  memset(w->bonds, 0, sizeof w->bonds);
  w->count = w->common = 0;
  w->of = NULL;
  if (points->count < FEWEST) return false;
  w->of = must_calloc((size_t)pairs->count + 1, sizeof *w->of);
  if (note_ways(points, pairs, ALIKE * spacing, w) &&
      2 * sort_ways(w, points->count, pairs->count) > pairs->count)
    return true;
  bond_ways_free(w);
  return false;
}

void bond_ways_free(bond_ways *w) {
  free(w->of);
  w->of = NULL;
}

/* --- lines ------------------------------------------------------------------------------------ */

typedef struct place {
  double layer, line, along;
  int32_t group, point; /* the layer, then the line, from 0 */
} place;

static void cross(const double a[3], const double b[3], double c[3]) {
  for (int k = 0; k < 3; k++)
    c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Along the way; across it in its plane with the most common other; across the plane. Unit
   vectors. */
static void find_axes(const bond_ways *w, int way, int dimensions, double axis[3][3]) {
  static const double up[3] = {0, 0, 1}, sideways[3] = {0, 1, 0}, ahead[3] = {1, 0, 0};
  const double *first = w->chord[way];
  cross(first, fabs(first[1]) < fabs(first[0]) ? sideways : ahead, axis[2]);
  if (dimensions == 2) memcpy(axis[2], up, sizeof up);
  for (int k = 0; k < w->common && dimensions == 3; k++) {
    double normal[3];
    cross(first, w->chord[k], normal);
    if (dot(normal, normal) < 1e-6 * dot(first, first) * dot(first, first)) continue;
    memcpy(axis[2], normal, sizeof normal);
    break;
  }
  memcpy(axis[0], first, sizeof axis[0]);
  cross(axis[2], axis[0], axis[1]);
  for (int k = 0; k < 3; k++) {
    const double length = sqrt(dot(axis[k], axis[k]));
    for (int a = 0; a < 3; a++)
      axis[k][a] /= length;
  }
}

static int by_layer(const void *a, const void *b) {
  const place *p = a, *q = b;
  return p->layer < q->layer ? -1 : p->layer > q->layer;
}

static int by_line(const void *a, const void *b) {
  const place *p = a, *q = b;
  if (p->group != q->group) return p->group < q->group ? -1 : 1;
  return p->line < q->line ? -1 : p->line > q->line;
}

static int by_place(const void *a, const void *b) {
  const place *p = a, *q = b;
  if (p->group != q->group) return p->group < q->group ? -1 : 1;
  return p->along < q->along ? -1 : p->along > q->along;
}

static place *places_of(const bond_ways *w, int way, const point_cloud *points) {
  place *p = must_alloc(((size_t)points->count + 1) * sizeof *p);
  double axis[3][3];
  find_axes(w, way, points->dimensions, axis);
  for (long r = 0; r < points->count; r++) {
    double at[3] = {0, 0, 0};
    for (int a = 0; a < points->dimensions; a++)
      at[a] = points->at[a][r];
    p[r] = (place){dot(at, axis[2]), dot(at, axis[1]), dot(at, axis[0]), 0, (int32_t)r};
  }
  return p;
}

/* Numbers layers, then lines, where the next is apart from the one before. Returns how many. */
static long number_lines(place *p, long count, double least) {
  int32_t group = 0;
  qsort(p, (size_t)count, sizeof *p, by_layer);
  for (long r = 1; r < count; r++)
    p[r].group = group += p[r].layer - p[r - 1].layer > least;
  qsort(p, (size_t)count, sizeof *p, by_line);
  int32_t layer = p[0].group, line = 0;
  for (long r = 0; r < count; r++) {
    line += p[r].group != layer || (r > 0 && p[r].line - p[r - 1].line > least);
    layer = p[r].group;
    p[r].group = line;
  }
  return line + 1;
}

long bond_ways_lines(const bond_ways *w, int way, const point_cloud *points, double spacing,
                     int32_t *order, int32_t **length) {
  place *p = places_of(w, way, points);
  const long lines = number_lines(p, points->count, APART * spacing);
  qsort(p, (size_t)points->count, sizeof *p, by_place);
  *length = must_calloc((size_t)lines + 1, sizeof **length);
  for (long r = 0; r < points->count; r++) {
    order[r] = p[r].point;
    (*length)[p[r].group]++;
  }
  free(p);
  return lines;
}
