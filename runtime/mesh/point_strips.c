#include "runtime/mesh/point_strips.h"

#include <stdlib.h>

#include "dsl/base/arena.h"
#include "runtime/kernel.h"

/* How groups become strips. */
typedef struct rule {
  bool apart;
  long points, of_rectangles;
} rule;

static bool is_of_rectangles(const rule *by, const cell_group *g) {
  return by->apart && g->even > 0;
}

/* Whether the next group goes on with a strip of these. */
static bool joins(const rule *by, const point_strip *s, const cell_group *groups) {
  const cell_group *first = &groups[s->first], *next = &groups[s->last];
  const long points = s->count + (long)next->points * PL_LANES;
  if (s->rectangles != is_of_rectangles(by, next)) return false;
  if (!s->rectangles) return points <= by->points;
  return points <= by->of_rectangles && next->even == first->even && next->table == first->table &&
         next->first == first->first + (s->last - s->first) * PL_LANES;
}

static point_strip next_strip(const cell_strips *s, const rule *by, int row, int first) {
  const cell_group *groups = s->groups;
  point_strip out = {.row = row,
                     .first = first,
                     .last = first,
                     .at = groups[first].at,
                     .rectangles = is_of_rectangles(by, &groups[first])};
  do
    out.count += (long)groups[out.last++].points * PL_LANES;
  while (out.last < s->first_group[row + 1] && joins(by, &out, groups));
  if (out.rectangles)
    out.push = rectangle_slopes_times(&groups[first].table->slopes, groups[first].even);
  return out;
}

point_strips *point_strips_new(const cell_strips *s, bool apart, long points, long of_rectangles) {
  const rule by = {apart, points, of_rectangles};
  point_strips *p = must_calloc(1, sizeof *p);
  int count = 0;
  p->items = must_calloc((size_t)s->group_count + 1, sizeof *p->items);
  p->first_of_row = must_calloc((size_t)s->rows + 1, sizeof *p->first_of_row);
  for (int row = 0; row < s->rows; row++) {
    p->first_of_row[row] = count;
    for (int g = s->first_group[row]; g < s->first_group[row + 1]; g = p->items[count++].last) {
      p->items[count] = next_strip(s, &by, row, g);
      if (p->items[count].count > p->most) p->most = p->items[count].count;
    }
  }
  p->first_of_row[s->rows] = count;
  p->items = must_realloc(p->items, ((size_t)count + 1) * sizeof *p->items);
  p->bytes = (long)sizeof *p->items * count + (long)sizeof(int) * s->rows;
  return p;
}

void point_strips_free(point_strips *p) {
  if (!p) return;
  free(p->items);
  free(p->first_of_row);
  free(p);
}
