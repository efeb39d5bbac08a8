#include "generator/results/curve_gap.h"

#include <math.h>

#include "dsl/base/elementary.h"

/* Mean over a piece of the square of what is positive of a straight line from a to b. */
static double positive_square(double a, double b) {
  if (a <= 0 && b <= 0) return 0;
  if (a >= 0 && b >= 0) return (a * a + a * b + b * b) / 3;
  const double most = pl_fmax(a, b);
  return most / fabs(a - b) * most * most / 3;
}

typedef struct ends { /* of a piece: below the band, above it */
  double below[2], above[2];
} ends;

static void look(curve_gap *g, const first_reach *c, long i, const first_reach *m, long j, double x,
                 int end, ends *e) {
  const double y = first_reach_between(c, c->low, i, x), low = first_reach_between(m, m->low, j, x),
               high = first_reach_between(m, m->high, j, x);
  e->below[end] = low - y;
  e->above[end] = y - high;
  const double distance = pl_fmax(pl_fmax(low - y, y - high), 0);
  if (distance < g->largest || (distance == g->largest && isfinite(g->x))) return;
  g->largest = distance;
  g->x = x;
  g->y = y;
  g->low = low;
  g->high = high;
}

/* A piece of either curve after the other; those without length are jumps. */
static double sum_of_squares(const first_reach *c, const first_reach *m, curve_gap *g) {
  double sum = 0;
  for (long i = 0, j = 0; i + 1 < c->count && j + 1 < m->count;) {
    const double from = pl_fmax(c->x[i], m->x[j]), to = pl_fmin(c->x[i + 1], m->x[j + 1]);
    if (to > from) {
      ends e;
      look(g, c, i, m, j, from, 0, &e);
      look(g, c, i, m, j, to, 1, &e);
      sum += (to - from) *
             (positive_square(e.below[0], e.below[1]) + positive_square(e.above[0], e.above[1]));
    }
    if (c->x[i + 1] <= m->x[j + 1])
      i++;
    else
      j++;
  }
  return sum;
}

bool curve_gap_find(const double *x, const double *y, long count, const curve_points *points,
                    curve_gap *gap) {
  const curve_points computed = {x, y, y, count};
  const double along = first_reach_direction(&computed, first_reach_x(&computed, 0, 1));
  const bool backwards =
      along * first_reach_x(points, points->count - 1, -1) < along * first_reach_x(points, 0, 1);
  first_reach c = first_reach_of(&computed, along, false),
              m = first_reach_of(points, along, backwards);
  *gap = (curve_gap){.x = NAN};
  const bool both = c.count && m.count;
  const double from = both ? pl_fmax(c.x[0], m.x[0]) : 0,
               to = both ? pl_fmin(c.x[c.count - 1], m.x[m.count - 1]) : 0;
  if (to > from) {
    gap->rms = sqrt(sum_of_squares(&c, &m, gap) / (to - from));
    gap->from = along * from;
    gap->to = along * to;
    gap->x *= along;
  }
  first_reach_free(&c);
  first_reach_free(&m);
  return to > from;
}
