#include "runtime/mesh/cell_lists.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

static const double ON_OUTLINE = 1e-6; /* cells */

void cell_lists_places(const cell_lists *l, int cell, double place_of[ELEMENT_MOST_NODES][2]) {
  for (int q = 0; q < l->nodes[cell] && q < ELEMENT_MOST_NODES; q++)
    memcpy(place_of[q], l->at[l->cell[cell][q]], sizeof place_of[q]);
}

static void *copy_of(const void *items, size_t size) {
  void *copy = must_alloc(size + 1);
  memcpy(copy, items, size);
  return copy;
}

/* --- around nodes ----------------------------------------------------------------------------- */

static void find_around(cell_lists *l) {
  const size_t nodes = (size_t)l->node_count + 2;
  l->first = must_calloc(nodes, sizeof *l->first);
  for (int c = 0; c < l->count; c++)
    for (int q = 0; q < l->nodes[c]; q++)
      l->first[l->cell[c][q] + 1]++;
  for (int n = 0; n < l->node_count; n++)
    l->first[n + 1] += l->first[n];
  l->around = must_alloc(((size_t)l->first[l->node_count] + 1) * sizeof *l->around);
  int32_t *at = copy_of(l->first, nodes * sizeof *at);
  for (int c = 0; c < l->count; c++)
    for (int q = 0; q < l->nodes[c]; q++)
      l->around[at[l->cell[c][q]]++] = c;
  free(at);
}

/* --- boxes ------------------------------------------------------------------------------------ */

/* A side with a node between is an arc of a parabola, which may rise above its nodes by less than a
   quarter of their extent. */
static void box_of(const cell_lists *l, int cell, double low[2], double high[2]) {
  for (int a = 0; a < 2; a++) {
    low[a] = INFINITY;
    high[a] = -INFINITY;
    for (int q = 0; q < l->nodes[cell]; q++) {
      low[a] = pl_min(low[a], l->at[l->cell[cell][q]][a]);
      high[a] = pl_max(high[a], l->at[l->cell[cell][q]][a]);
    }
  }
  const double size = pl_max(high[0] - low[0], high[1] - low[1]),
               more = (l->nodes[cell] == 6 ? 0.25 : 2 * ON_OUTLINE) * size;
  for (int a = 0; a < 2; a++) {
    low[a] -= more;
    high[a] += more;
  }
}

static int box_at(const cell_lists *l, int axis, double x) {
  const double k = floor((x - l->low[axis]) / l->box);
  return k < 0 ? 0 : k > l->boxes[axis] - 1 ? l->boxes[axis] - 1 : (int)k;
}

/* The boxes that a cell's own box reaches: from, to along each axis. */
static void boxes_of(const cell_lists *l, int cell, int from[2], int to[2]) {
  double low[2], high[2];
  box_of(l, cell, low, high);
  for (int a = 0; a < 2; a++) {
    from[a] = box_at(l, a, low[a]);
    to[a] = box_at(l, a, high[a]);
  }
}

/* How many places all cells take in boxes. */
static int64_t entries_of(const cell_lists *l) {
  int64_t sum = 0;
  for (int c = 0; c < l->count; c++) {
    int from[2], to[2];
    boxes_of(l, c, from, to);
    sum += (int64_t)(to[0] - from[0] + 1) * (to[1] - from[1] + 1);
  }
  return sum;
}

/* Counts cells in boxes, or puts them there where `at` says how far each is filled. */
static void visit_boxes(cell_lists *l, int64_t *at) {
  for (int c = 0; c < l->count; c++) {
    int from[2], to[2];
    boxes_of(l, c, from, to);
    for (int j = from[1]; j <= to[1]; j++)
      for (int i = from[0]; i <= to[0]; i++) {
        const int box = j * l->boxes[0] + i;
        if (at)
          l->in[at[box]++] = c;
        else
          l->first_in[box + 1]++;
      }
  }
}

/* What all cells reach, m; the mean of their sides. */
static double find_extent(cell_lists *l, double size[2]) {
  double high[2] = {-INFINITY, -INFINITY}, sides = 0;
  l->low[0] = l->low[1] = INFINITY;
  for (int c = 0; c < l->count; c++) {
    double from[2], to[2];
    box_of(l, c, from, to);
    for (int a = 0; a < 2; a++) {
      l->low[a] = pl_min(l->low[a], from[a]);
      high[a] = pl_max(high[a], to[a]);
      sides += 0.5 * (to[a] - from[a]) / l->count;
    }
  }
  for (int a = 0; a < 2; a++)
    size[a] = high[a] - l->low[a];
  return sides;
}

/* About as many boxes as cells, each as large as the mean cell's; larger ones where long cells lie
   across many. */
static void choose_boxes(cell_lists *l) {
  enum { MOST_BOXES = 2000, MOST_ENTRIES = 16 /* a cell, in the mean */ };
  double size[2];
  const double sides = find_extent(l, size);
  l->box = 0.5 * pl_max(sides, pl_max(size[0], size[1]) / MOST_BOXES);
  do {
    l->box *= 2;
    for (int a = 0; a < 2; a++)
      l->boxes[a] = 1 + (int)(size[a] / l->box);
  } while (entries_of(l) > (int64_t)MOST_ENTRIES * l->count);
}

static void find_boxes(cell_lists *l) {
  choose_boxes(l);
  const size_t boxes = (size_t)l->boxes[0] * (size_t)l->boxes[1];
  l->first_in = must_calloc(boxes + 1, sizeof *l->first_in);
  visit_boxes(l, NULL);
  for (size_t k = 0; k < boxes; k++)
    l->first_in[k + 1] += l->first_in[k];
  l->in = must_alloc(((size_t)l->first_in[boxes] + 1) * sizeof *l->in);
  int64_t *at = copy_of(l->first_in, (boxes + 1) * sizeof *at);
  visit_boxes(l, at);
  free(at);
}

cell_lists *cell_lists_new(int node_count, const double (*at)[2], int count,
                           const unsigned char *nodes, const cell_nodes *cell) {
  cell_lists *l = must_calloc(1, sizeof *l);
  l->node_count = node_count;
  l->count = count;
  l->at = copy_of(at, (size_t)node_count * sizeof *at);
  l->nodes = copy_of(nodes, (size_t)count);
  l->cell = copy_of(cell, (size_t)count * sizeof *cell);
  find_around(l);
  find_boxes(l);
  return l;
}

void cell_lists_free(cell_lists *l) {
  if (!l) return;
  free(l->at);
  free(l->nodes);
  free(l->cell);
  free(l->first);
  free(l->around);
  free(l->first_in);
  free(l->in);
  free(l);
}

int cell_lists_find(const cell_lists *l, const double at[2], double u[2]) {
  int found = -1;
  double least = ON_OUTLINE;
  for (int a = 0; a < 2; a++)
    if (!(at[a] >= l->low[a] && at[a] <= l->low[a] + l->box * l->boxes[a])) return -1;
  const int box = box_at(l, 1, at[1]) * l->boxes[0] + box_at(l, 0, at[0]);
  for (int64_t k = l->first_in[box]; k < l->first_in[box + 1]; k++) {
    const int cell = l->in[k];
    double corner[ELEMENT_MOST_NODES][2], here[2];
    cell_lists_places(l, cell, corner);
    if (!element_unmap(l->nodes[cell], (const double(*)[2])corner, at, here)) continue;
    const double outside = pl_max(0, element_outside(l->nodes[cell], here));
    if (!(outside < least)) continue;
    least = outside;
    found = cell;
    memcpy(u, here, sizeof here);
  }
  return found;
}
