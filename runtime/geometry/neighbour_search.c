#include "runtime/geometry/neighbour_search.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/geometry/bins.h"

enum { POINTS_A_BOX = 2 };

typedef struct search { /* points, and which of them are in each box */
  const point_cloud *points;
  bins bins;
} search;

static search search_new(const point_cloud *c) {
  search s = {.points = c};
  bins_of_few(&s.bins, c->dimensions, c->at, c->count, POINTS_A_BOX);
  return s;
}

static void search_free(search *s) {
  bins_end(&s->bins);
}

static void point_at(const point_cloud *c, long p, double at[3]) {
  for (int a = 0; a < 3; a++)
    at[a] = a < c->dimensions ? c->at[a][p] : 0;
}

/* --- walks over boxes ------------------------------------------------------------------------- */

typedef struct walk {
  const search *in;
  double from[3];
  int low[3], high[3]; /* boxes looked at */
} walk;

/* Something is done with every point of a box; true ends the walk. */
typedef bool (*point_visit)(void *of, int32_t point, double square);

static double square_to(const walk *w, int32_t point) {
  double square = 0;
  for (int a = 0; a < w->in->points->dimensions; a++) {
    const double d = w->in->points->at[a][point] - w->from[a];
    square += d * d;
  }
  return square;
}

static bool visit_run(const walk *w, int64_t from, int64_t to, point_visit visit, void *of) {
  const bins *b = &w->in->bins;
  for (int32_t k = b->first[from]; k < b->first[to + 1]; k++)
    if (visit(of, b->point[k], square_to(w, b->point[k]))) return true;
  return false;
}

/* Boxes from low to high that do not lie among those `seen` (NULL: none does), a row of them at a
   time. */
static bool visit_boxes(const walk *w, const walk *seen, point_visit visit, void *of) {
  int box[3];
  for (box[2] = w->low[2]; box[2] <= w->high[2]; box[2]++)
    for (box[1] = w->low[1]; box[1] <= w->high[1]; box[1]++) {
      box[0] = 0;
      const int64_t row = boxes_number(&w->in->bins.boxes, box);
      const bool through = seen && box[1] >= seen->low[1] && box[1] <= seen->high[1] &&
                           box[2] >= seen->low[2] && box[2] <= seen->high[2];
      const int end = through ? seen->low[0] - 1 : w->high[0];
      if (w->low[0] <= end && visit_run(w, row + w->low[0], row + end, visit, of)) return true;
      if (through && seen->high[0] < w->high[0] &&
          visit_run(w, row + seen->high[0] + 1, row + w->high[0], visit, of))
        return true;
    }
  return false;
}

static walk walk_from(const search *s, const double from[3], double distance) {
  walk w = {.in = s};
  memcpy(w.from, from, sizeof w.from);
  for (int a = 0; a < s->points->dimensions; a++) {
    w.low[a] = boxes_along(&s->bins.boxes, a, from[a] - distance);
    w.high[a] = boxes_along(&s->bins.boxes, a, from[a] + distance);
  }
  return w;
}

/* One box more on all sides; false when there is none. */
static bool widen(walk *w) {
  const int *count = w->in->bins.boxes.count;
  bool wider = false;
  for (int a = 0; a < 3; a++) {
    wider = wider || w->low[a] > 0 || w->high[a] < count[a] - 1;
    if (w->low[a] > 0) w->low[a]--;
    if (w->high[a] < count[a] - 1) w->high[a]++;
  }
  return wider;
}

/* All points nearer than this were looked at. */
static double seen_to(const walk *w) {
  const boxes *b = &w->in->bins.boxes;
  double least = INFINITY;
  for (int a = 0; a < w->in->points->dimensions; a++) {
    const double low = b->lower[a], side = b->size;
    if (w->low[a] > 0) least = pl_fmin(least, w->from[a] - (low + (double)w->low[a] * side));
    if (w->high[a] < b->count[a] - 1)
      least = pl_fmin(least, low + (double)(w->high[a] + 1) * side - w->from[a]);
  }
  return pl_fmax(least, 0) * (1 - 1e-12); /* boxes were found to rounding */
}

/* --- the nearest ------------------------------------------------------------------------------ */

typedef struct candidate {
  double square;
  int32_t point;
} candidate;

typedef struct nearest_list {
  const point_cloud *points;
  int32_t own;
  int wanted, count;
  candidate *items; /* nearest first */
} nearest_list;

static bool is_nearer(const point_cloud *c, candidate a, candidate b) {
  if (a.square != b.square) return a.square < b.square;
  for (int k = 0; k < c->dimensions; k++)
    if (c->at[k][a.point] != c->at[k][b.point]) return c->at[k][a.point] < c->at[k][b.point];
  return a.point < b.point;
}

static bool take_nearer(void *of, int32_t point, double square) {
  nearest_list *l = of;
  const candidate new = {square, point};
  if (point == l->own) return false;
  if (l->count == l->wanted && !is_nearer(l->points, new, l->items[l->count - 1])) return false;
  int at = l->count < l->wanted ? l->count++ : l->count - 1;
  for (; at > 0 && is_nearer(l->points, new, l->items[at - 1]); at--)
    l->items[at] = l->items[at - 1];
  l->items[at] = new;
  return false;
}

static void find_nearest(const search *s, nearest_list *l) {
  double from[3];
  point_at(l->points, l->own, from);
  walk w = walk_from(s, from, 0), seen = w;
  l->count = 0;
  visit_boxes(&w, NULL, take_nearer, l);
  for (;;) {
    const double reach = seen_to(&w);
    if (l->count == l->wanted && l->items[l->count - 1].square < reach * reach) return;
    seen = w;
    if (!widen(&w)) return;
    visit_boxes(&w, &seen, take_nearer, l);
  }
}

/* --- pairs ------------------------------------------------------------------------------------ */

static void add_pair(point_pairs *l, long *room, int32_t i, int32_t j) {
  if (l->count == *room) {
    *room = 2 * *room + 64;
    l->items = must_realloc(l->items, (size_t)*room * sizeof *l->items);
  }
  l->items[l->count++] = i < j ? (point_pair){i, j} : (point_pair){j, i};
}

static bool is_among(const int32_t *list, int count, long point) {
  for (int k = 0; k < count; k++)
    if (list[k] == point) return true;
  return false;
}

static long find_crowded(const point_pairs *l, long points, int most) {
  int32_t *count = must_calloc((size_t)points + 1, sizeof *count);
  long crowded = -1;
  for (long m = 0; m < l->count; m++) {
    count[l->items[m].i]++;
    count[l->items[m].j]++;
  }
  for (long p = 0; p < points && crowded < 0; p++)
    if (count[p] > most) crowded = p;
  free(count);
  return crowded;
}

point_pairs pairs_of_nearest(const point_cloud *c, int nearest, int most) {
  point_pairs pairs = {.crowded = -1};
  long room = 0;
  const int wanted = nearest < c->count ? nearest : (int)(c->count > 0 ? c->count - 1 : 0);
  if (wanted == 0) return pairs;
  search s = search_new(c);
  int32_t *lists = must_alloc((size_t)c->count * (size_t)wanted * sizeof *lists);
  candidate *items = must_alloc((size_t)wanted * sizeof *items);
  for (long p = 0; p < c->count; p++) {
    nearest_list l = {.points = c, .own = (int32_t)p, .wanted = wanted, .items = items};
    find_nearest(&s, &l);
    for (int k = 0; k < wanted; k++)
      lists[p * wanted + k] = items[k].point;
  }
  for (long p = 0; p < c->count; p++)
    for (int k = 0; k < wanted; k++) {
      const int32_t q = lists[p * wanted + k];
      if (p < q || !is_among(lists + (long)q * wanted, wanted, p))
        add_pair(&pairs, &room, (int32_t)p, q);
    }
  pairs.crowded = find_crowded(&pairs, c->count, most);
  free(lists);
  free(items);
  search_free(&s);
  return pairs;
}

typedef struct reach_list {
  point_pairs *pairs;
  long *room;
  int32_t own;
  double square;
  const double *reach; /* of each point, or NULL: `square` is that of all */
  int found, most;
} reach_list;

static double square_of(const reach_list *l, int32_t point) {
  if (!l->reach) return l->square;
  const double mean = 0.5 * (l->reach[l->own] + l->reach[point]);
  return mean * mean;
}

static bool take_within(void *of, int32_t point, double square) {
  reach_list *l = of;
  if (point == l->own || !(square <= square_of(l, point))) return false;
  if (point > l->own) add_pair(l->pairs, l->room, l->own, point);
  return ++l->found > l->most;
}

static double largest_of(const double *values, long count) {
  double largest = 0;
  for (long k = 0; k < count; k++)
    largest = pl_fmax(largest, values[k]);
  return largest;
}

/* `reach` as in reach_list. */
static point_pairs find_within(const point_cloud *c, double distance, const double *reach,
                               int most) {
  point_pairs pairs = {.crowded = -1};
  long room = 0;
  if (c->count == 0) return pairs;
  search s = search_new(c);
  for (long p = 0; p < c->count && pairs.crowded < 0; p++) {
    double from[3];
    point_at(c, p, from);
    const walk w = walk_from(&s, from, reach ? 0.5 * (reach[p] + distance) : distance);
    reach_list l = {&pairs, &room, (int32_t)p, distance * distance, reach, 0, most};
    if (visit_boxes(&w, NULL, take_within, &l)) pairs.crowded = p;
  }
  search_free(&s);
  return pairs;
}

point_pairs pairs_within(const point_cloud *c, double distance, int most) {
  return find_within(c, distance, NULL, most);
}

point_pairs pairs_within_own(const point_cloud *c, const double *reach, int most) {
  return find_within(c, largest_of(reach, c->count), reach, most);
}

/* --- near some -------------------------------------------------------------------------------- */

static bool is_within(void *square, int32_t point, double found) {
  (void)point;
  return found <= *(const double *)square;
}

void points_near(const point_cloud *c, const int32_t *chosen, long chosen_count, double distance,
                 unsigned char *near) {
  point_cloud some = {.dimensions = c->dimensions, .count = chosen_count};
  double *at = must_alloc((3 * (size_t)chosen_count + 1) * sizeof *at);
  double square = distance * distance;
  memset(near, 0, (size_t)c->count);
  for (int a = 0; a < c->dimensions; a++) {
    some.at[a] = at + a * chosen_count;
    for (long p = 0; p < chosen_count; p++)
      at[a * chosen_count + p] = c->at[a][chosen[p]];
  }
  if (chosen_count > 0) {
    search s = search_new(&some);
    for (long p = 0; p < c->count; p++) {
      double from[3];
      point_at(c, p, from);
      const walk w = walk_from(&s, from, distance);
      near[p] = visit_boxes(&w, NULL, is_within, &square);
    }
    search_free(&s);
  }
  free(at);
}
