#include "runtime/geometry/cell_overlap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

static const double ON_SIDE = 1e-6; /* of a cell's height above the side */
enum { LEAF = 8, MOST_CORNERS = 4 };

/* Points in a tree of halves: `order` is parted at its middle by x, each half by y, and so on. */
typedef struct tree {
  double (*at)[2]; /* [count] nodes, then middles of cells */
  int32_t *order;
  long count;
} tree;

/* --- the tree --------------------------------------------------------------------------------- */

/* So that those before `middle` have no larger coordinates than it, those behind no smaller
   ones. */
static void part(const tree *t, long first, long last, long middle, int axis) {
  while (first < last) {
    const double pivot = t->at[t->order[first + (last - first) / 2]][axis];
    long i = first, j = last;
    while (i <= j) {
      while (t->at[t->order[i]][axis] < pivot)
        i++;
      while (t->at[t->order[j]][axis] > pivot)
        j--;
      if (i > j) break;
      const int32_t kept = t->order[i];
      t->order[i++] = t->order[j];
      t->order[j--] = kept;
    }
    if (middle <= j)
      last = j;
    else if (middle >= i)
      first = i;
    else
      return;
  }
}

static void grow(const tree *t, long first, long end, int axis) {
  const long middle = first + (end - first) / 2;
  if (end - first <= LEAF) return;
  part(t, first, end - 1, middle, axis);
  grow(t, first, middle, !axis);
  grow(t, middle + 1, end, !axis);
}

static void middle_of(const overlap_cells *of, int cell, double at[2]) {
  const double third = 1.0 / 3,
               u[2] = {of->nodes[cell] == 4 ? 0 : third, of->nodes[cell] == 4 ? 0 : third};
  double place[ELEMENT_MOST_NODES][2];
  for (int q = 0; q < of->nodes[cell] && q < ELEMENT_MOST_NODES; q++)
    memcpy(place[q], of->at[of->cell[cell][q]], sizeof place[q]);
  element_map(of->nodes[cell], (const double(*)[2])place, u, at, NULL);
}

static tree tree_of(const overlap_cells *of) {
  tree t = {.count = (long)of->node_count + of->count};
  t.at = must_alloc(((size_t)t.count + 1) * sizeof *t.at);
  t.order = must_alloc(((size_t)t.count + 1) * sizeof *t.order);
  memcpy(t.at, of->at, (size_t)of->node_count * sizeof *t.at);
  for (int c = 0; c < of->count; c++)
    middle_of(of, c, t.at[of->node_count + c]);
  for (long n = 0; n < t.count; n++)
    t.order[n] = (int32_t)n;
  grow(&t, 0, t.count, 0);
  return t;
}

/* --- a cell and a point ----------------------------------------------------------------------- */

typedef struct asker {
  const overlap_cells *of;
  const tree *t;
  int cell, nodes, corners;
  double place[ELEMENT_MOST_NODES][2], low[2], high[2], area;
  cell_overlap *found;
} asker;

/* How high a point is above each side, in parts of the cell; false far outside. */
static bool heights(const asker *a, const double at[2], double height[MOST_CORNERS]) {
  if (a->nodes == 6) {
    double u[2];
    if (!element_unmap(6, (const double(*)[2])a->place, at, u)) return false;
    height[0] = u[1];
    height[1] = 1 - u[0] - u[1];
    height[2] = u[0];
    return true;
  }
  for (int q = 0; q < a->corners; q++) {
    const double *from = a->place[q], *to = a->place[(q + 1) % a->corners];
    height[q] =
        ((to[0] - from[0]) * (at[1] - from[1]) - (to[1] - from[1]) * (at[0] - from[0])) / a->area;
  }
  return true;
}

/* It is a node of the cell, or stands where one does. */
static bool is_own(const asker *a, int32_t point) {
  if (point >= a->of->node_count) return point - a->of->node_count == a->cell;
  for (int q = 0; q < a->nodes; q++) {
    const double *at = a->of->at[point];
    if (a->of->cell[a->cell][q] == point ||
        pl_hypot(at[0] - a->place[q][0], at[1] - a->place[q][1]) <= a->of->same)
      return true;
  }
  return false;
}

static bool lies_over(const asker *a, int32_t point) {
  double height[MOST_CORNERS], least = INFINITY;
  const bool is_node = point < a->of->node_count;
  int lowest = -1;
  const double *at = a->t->at[point];
  for (int k = 0; k < 2; k++)
    if (!(at[k] >= a->low[k] && at[k] <= a->high[k])) return false;
  if (is_own(a, point) || !heights(a, at, height)) return false;
  for (int q = 0; q < a->corners; q++)
    if (height[q] < least) least = height[lowest = q];
  if (!(least > (is_node ? -ON_SIDE : ON_SIDE))) return false;
  *a->found = (cell_overlap){.cell = a->cell,
                             .side = least > ON_SIDE ? -1 : lowest,
                             .node = is_node ? point : -1,
                             .other = is_node ? -1 : point - a->of->node_count};
  return true;
}

/* Points of a part of the tree that lie in the cell's box. */
static bool ask(const asker *a, long first, long end, int axis) {
  if (end - first <= LEAF) {
    for (long n = first; n < end; n++)
      if (lies_over(a, a->t->order[n])) return true;
    return false;
  }
  const long middle = first + (end - first) / 2;
  const int32_t point = a->t->order[middle];
  const double parted = a->t->at[point][axis];
  return (a->low[axis] <= parted && ask(a, first, middle, !axis)) || lies_over(a, point) ||
         (a->high[axis] >= parted && ask(a, middle + 1, end, !axis));
}

/* An arc of 6 nodes rises above them by less than a quarter of their extent. */
static void take_cell(asker *a, int cell) {
  a->cell = cell;
  a->nodes = a->of->nodes[cell];
  a->corners = element_corners(a->nodes);
  for (int k = 0; k < 2; k++) {
    a->low[k] = INFINITY;
    a->high[k] = -INFINITY;
    for (int q = 0; q < a->nodes && q < ELEMENT_MOST_NODES; q++) {
      const double x = a->place[q][k] = a->of->at[a->of->cell[cell][q]][k];
      a->low[k] = pl_min(a->low[k], x);
      a->high[k] = pl_max(a->high[k], x);
    }
  }
  a->area = element_area(a->nodes, (const double(*)[2])a->place);
  const double size = pl_max(a->high[0] - a->low[0], a->high[1] - a->low[1]),
               more = (a->nodes == 6 ? 0.25 : 2 * ON_SIDE) * size;
  for (int k = 0; k < 2; k++) {
    a->low[k] -= more;
    a->high[k] += more;
  }
}

bool cell_overlap_find(const overlap_cells *of, cell_overlap *found) {
  const tree t = tree_of(of);
  asker a = {.of = of, .t = &t, .found = found};
  bool any = false;
  for (int c = 0; c < of->count && !any; c++) {
    take_cell(&a, c);
    any = ask(&a, 0, t.count, 0);
  }
  free(t.at);
  free(t.order);
  return any;
}
