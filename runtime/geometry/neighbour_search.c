#include "runtime/geometry/neighbour_search.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/geometry/bins.h"

enum { POINTS_A_CELL = 2, MOST_CELLS = 1 << 20 /* along an axis */ };

/* --- cells ------------------------------------------------------------------------------------ */

typedef struct cell_grid {
  const point_cloud *points;
  double low[3], side; /* m */
  long cells[3];
  int32_t *first; /* [all cells + 1] into `order` */
  int32_t *order; /* points, cell by cell */
} cell_grid;

static long cell_along(const cell_grid *g, int axis, double x) {
  const double k = floor((x - g->low[axis]) / g->side);
  return k <= 0 ? 0 : k >= (double)g->cells[axis] ? g->cells[axis] - 1 : (long)k;
}

static void cell_of(const cell_grid *g, const double at[3], long cell[3]) {
  for (int a = 0; a < 3; a++)
    cell[a] = a < g->points->dimensions ? cell_along(g, a, at[a]) : 0;
}

static long cell_number(const cell_grid *g, const long cell[3]) {
  return (cell[2] * g->cells[1] + cell[1]) * g->cells[0] + cell[0];
}

static void point_at(const point_cloud *c, long p, double at[3]) {
  for (int a = 0; a < 3; a++)
    at[a] = a < c->dimensions ? c->at[a][p] : 0;
}

/* A side with so many points a cell of the box around nearly all of them (others are in the cells at its sides); axes along
   which the box is thinner than a cell do not count. */
static void choose_cells(cell_grid *g, const double extent[3]) {
  bool flat[3] = {false, false, false};
  g->side = 0;
  for (int round = 0; round < 3; round++) {
    double measure = 1;
    int axes = 0;
    for (int a = 0; a < g->points->dimensions; a++) {
      flat[a] = flat[a] || extent[a] <= g->side;
      if (flat[a]) continue;
      measure *= extent[a];
      axes++;
    }
    if (axes > 0) g->side = pl_pow(measure * POINTS_A_CELL / (double)g->points->count, 1.0 / axes);
  }
  if (!(g->side > 0)) g->side = 1; /* all points are one */
  for (int a = 0; a < 3; a++) {
    const double wanted = flat[a] || a >= g->points->dimensions ? 1 : ceil(extent[a] / g->side);
    g->cells[a] = wanted < 1 ? 1 : wanted > MOST_CELLS ? MOST_CELLS : (long)wanted;
  }
}

static cell_grid grid_new(const point_cloud *c) {
  cell_grid g = {.points = c};
  double extent[3] = {0, 0, 0}, range[2], at[3];
  long cell[3];
  for (int a = 0; a < c->dimensions; a++) {
    bins_range(c->at[a], c->count, range);
    g.low[a] = range[0];
    extent[a] = range[1] - range[0];
  }
  choose_cells(&g, extent);
  const long all = g.cells[0] * g.cells[1] * g.cells[2];
  g.first = must_calloc((size_t)all + 2, sizeof *g.first);
  g.order = must_alloc(((size_t)c->count + 1) * sizeof *g.order);
  for (int round = 0; round < 2; round++) { /* count, then sort in */
    for (long p = 0; p < c->count; p++) {
      point_at(c, p, at);
      cell_of(&g, at, cell);
      const long n = cell_number(&g, cell);
      if (round == 0)
        g.first[n + 2]++;
      else
        g.order[g.first[n + 1]++] = (int32_t)p;
    }
    for (long n = 0; round == 0 && n < all; n++)
      g.first[n + 2] += g.first[n + 1];
  }
  return g;
}

static void grid_free(cell_grid *g) {
  free(g->first);
  free(g->order);
}

/* --- walks over cells ------------------------------------------------------------------------- */

typedef struct walk {
  const cell_grid *grid;
  double from[3];
  long low[3], high[3]; /* cells looked at */
} walk;

/* Something is done with every point of a cell; true ends the walk. */
typedef bool (*point_visit)(void *of, int32_t point, double square);

static double square_to(const walk *w, int32_t point) {
  double square = 0;
  for (int a = 0; a < w->grid->points->dimensions; a++) {
    const double d = w->grid->points->at[a][point] - w->from[a];
    square += d * d;
  }
  return square;
}

static bool visit_run(const walk *w, long from, long to, point_visit visit, void *of) {
  const cell_grid *g = w->grid;
  for (int32_t k = g->first[from]; k < g->first[to + 1]; k++)
    if (visit(of, g->order[k], square_to(w, g->order[k]))) return true;
  return false;
}

/* Cells of the box low .. high that do not lie in the box `seen` (NULL: none does). */
static bool visit_box(const walk *w, const walk *seen, point_visit visit, void *of) {
  long cell[3];
  for (cell[2] = w->low[2]; cell[2] <= w->high[2]; cell[2]++)
    for (cell[1] = w->low[1]; cell[1] <= w->high[1]; cell[1]++) {
      cell[0] = 0;
      const long row = cell_number(w->grid, cell);
      const bool through = seen && cell[1] >= seen->low[1] && cell[1] <= seen->high[1] &&
                           cell[2] >= seen->low[2] && cell[2] <= seen->high[2];
      const long end = through ? seen->low[0] - 1 : w->high[0];
      if (w->low[0] <= end && visit_run(w, row + w->low[0], row + end, visit, of)) return true;
      if (through && seen->high[0] < w->high[0] &&
          visit_run(w, row + seen->high[0] + 1, row + w->high[0], visit, of))
        return true;
    }
  return false;
}

static walk walk_from(const cell_grid *g, const double from[3], double distance) {
  walk w = {.grid = g};
  memcpy(w.from, from, sizeof w.from);
  for (int a = 0; a < g->points->dimensions; a++) {
    w.low[a] = cell_along(g, a, from[a] - distance);
    w.high[a] = cell_along(g, a, from[a] + distance);
  }
  return w;
}

/* One cell more on all sides; false when there is none. */
static bool widen(walk *w) {
  bool wider = false;
  for (int a = 0; a < 3; a++) {
    wider = wider || w->low[a] > 0 || w->high[a] < w->grid->cells[a] - 1;
    if (w->low[a] > 0) w->low[a]--;
    if (w->high[a] < w->grid->cells[a] - 1) w->high[a]++;
  }
  return wider;
}

/* All points nearer than this were looked at. */
static double seen_to(const walk *w) {
  double least = INFINITY;
  for (int a = 0; a < w->grid->points->dimensions; a++) {
    const double low = w->grid->low[a], side = w->grid->side;
    if (w->low[a] > 0) least = pl_fmin(least, w->from[a] - (low + (double)w->low[a] * side));
    if (w->high[a] < w->grid->cells[a] - 1)
      least = pl_fmin(least, low + (double)(w->high[a] + 1) * side - w->from[a]);
  }
  return pl_fmax(least, 0) * (1 - 1e-12); /* cells were found to rounding */
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

static void find_nearest(const cell_grid *g, nearest_list *l) {
  double from[3];
  point_at(l->points, l->own, from);
  walk w = walk_from(g, from, 0), seen = w;
  l->count = 0;
  visit_box(&w, NULL, take_nearer, l);
  for (;;) {
    const double reach = seen_to(&w);
    if (l->count == l->wanted && l->items[l->count - 1].square < reach * reach) return;
    seen = w;
    if (!widen(&w)) return;
    visit_box(&w, &seen, take_nearer, l);
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
  cell_grid g = grid_new(c);
  int32_t *lists = must_alloc((size_t)c->count * (size_t)wanted * sizeof *lists);
  candidate *items = must_alloc((size_t)wanted * sizeof *items);
  for (long p = 0; p < c->count; p++) {
    nearest_list l = {.points = c, .own = (int32_t)p, .wanted = wanted, .items = items};
    find_nearest(&g, &l);
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
  grid_free(&g);
  return pairs;
}

typedef struct reach_list {
  point_pairs *pairs;
  long *room;
  int32_t own;
  double square;
  int found, most;
} reach_list;

static bool take_within(void *of, int32_t point, double square) {
  reach_list *l = of;
  if (point == l->own || !(square <= l->square)) return false;
  if (point > l->own) add_pair(l->pairs, l->room, l->own, point);
  return ++l->found > l->most;
}

point_pairs pairs_within(const point_cloud *c, double distance, int most) {
  point_pairs pairs = {.crowded = -1};
  long room = 0;
  if (c->count == 0) return pairs;
  cell_grid g = grid_new(c);
  for (long p = 0; p < c->count && pairs.crowded < 0; p++) {
    double from[3];
    point_at(c, p, from);
    const walk w = walk_from(&g, from, distance);
    reach_list l = {&pairs, &room, (int32_t)p, distance * distance, 0, most};
    if (visit_box(&w, NULL, take_within, &l)) pairs.crowded = p;
  }
  grid_free(&g);
  return pairs;
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
    cell_grid g = grid_new(&some);
    for (long p = 0; p < c->count; p++) {
      double from[3];
      point_at(c, p, from);
      const walk w = walk_from(&g, from, distance);
      near[p] = visit_box(&w, NULL, is_within, &square);
    }
    grid_free(&g);
  }
  free(at);
}
