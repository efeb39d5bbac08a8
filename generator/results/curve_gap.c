#include "generator/results/curve_gap.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

/* Ascending in x times the direction; equal x are a jump. */
typedef struct ascent {
  double *x, *low, *high; /* [2*count] at most */
  long count;
} ascent;

static bool is_point(const curve_points *p, long k) {
  return isfinite(p->x[k]) && isfinite(p->low[k]) && isfinite(p->high[k]);
}

static void push(ascent *a, double x, double low, double high) {
  a->x[a->count] = x;
  a->low[a->count] = low;
  a->high[a->count++] = high;
}

/* Where the way between two points passes x. */
static void push_between(ascent *a, const curve_points *p, long i, long j, double along, double x) {
  const double part = (x - along * p->x[i]) / (along * (p->x[j] - p->x[i]));
  push(a, x, p->low[i] + part * (p->low[j] - p->low[i]),
       p->high[i] + part * (p->high[j] - p->high[i]));
}

/* `along` is 1 or -1. */
static ascent ascent_of(const curve_points *p, double along, bool backwards) {
  ascent a = {.count = 0};
  double **columns[] = {&a.x, &a.low, &a.high};
  for (int c = 0; c < 3; c++)
    *columns[c] = must_alloc((2 * (size_t)p->count + 1) * sizeof(double));
  long before = -1;
  for (long n = 0; n < p->count; n++) {
    const long k = backwards ? p->count - 1 - n : n;
    if (!is_point(p, k)) continue;
    const double x = along * p->x[k], reached = a.count ? a.x[a.count - 1] : -INFINITY;
    if (x > reached) {
      if (before >= 0 && along * p->x[before] < reached)
        push_between(&a, p, before, k, along, reached);
      push(&a, x, p->low[k], p->high[k]);
    }
    before = k;
  }
  return a;
}

static void ascent_free(ascent *a) {
  free(a->x);
  free(a->low);
  free(a->high);
}

static double first_x(const curve_points *p, long from, long step) {
  for (; from >= 0 && from < p->count; from += step)
    if (is_point(p, from)) return p->x[from];
  return NAN;
}

/* 1 where x goes farther up from its first value than down, else -1. */
static double direction_of(const curve_points *p) {
  const double first = first_x(p, 0, 1);
  double up = 0, down = 0;
  for (long k = 0; k < p->count; k++) {
    if (!is_point(p, k)) continue;
    up = pl_fmax(up, p->x[k] - first);
    down = pl_fmax(down, first - p->x[k]);
  }
  return up >= down ? 1 : -1;
}

/* --- pieces that both have -------------------------------------------------------------------- */

static double on_piece(const ascent *a, const double *values, long k, double x) {
  const double part = (x - a->x[k]) / (a->x[k + 1] - a->x[k]);
  return part >= 1 ? values[k + 1] : values[k] + part * (values[k + 1] - values[k]);
}

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

static void look(curve_gap *g, const ascent *c, long i, const ascent *m, long j, double x, int end,
                 ends *e) {
  const double y = on_piece(c, c->low, i, x), low = on_piece(m, m->low, j, x),
               high = on_piece(m, m->high, j, x);
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
static double sum_of_squares(const ascent *c, const ascent *m, curve_gap *g) {
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
  const double along = direction_of(&computed);
  const bool backwards =
      along * first_x(points, points->count - 1, -1) < along * first_x(points, 0, 1);
  ascent c = ascent_of(&computed, along, false), m = ascent_of(points, along, backwards);
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
  ascent_free(&c);
  ascent_free(&m);
  return to > from;
}
