#include "generator/results/first_reach.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

static bool is_point(const curve_points *p, long k) {
  return isfinite(p->x[k]) && isfinite(p->low[k]) && isfinite(p->high[k]);
}

static void push(first_reach *a, double x, double low, double high) {
  a->x[a->count] = x;
  a->low[a->count] = low;
  a->high[a->count++] = high;
}

/* Where the way between two points passes x. */
static void push_between(first_reach *a, const curve_points *p, long i, long j, double along,
                         double x) {
  const double part = (x - along * p->x[i]) / (along * (p->x[j] - p->x[i]));
  push(a, x, p->low[i] + part * (p->low[j] - p->low[i]),
       p->high[i] + part * (p->high[j] - p->high[i]));
}

first_reach first_reach_of(const curve_points *p, double along, bool backwards) {
  first_reach a = {.count = 0};
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

void first_reach_free(first_reach *a) {
  free(a->x);
  free(a->low);
  free(a->high);
}

double first_reach_x(const curve_points *p, long from, long step) {
  for (; from >= 0 && from < p->count; from += step)
    if (is_point(p, from)) return p->x[from];
  return NAN;
}

double first_reach_direction(const curve_points *p, double first) {
  double up = 0, down = 0;
  for (long k = 0; k < p->count; k++) {
    if (!is_point(p, k)) continue;
    up = pl_fmax(up, p->x[k] - first);
    down = pl_fmax(down, first - p->x[k]);
  }
  return up >= down ? 1 : -1;
}

double first_reach_between(const first_reach *a, const double *values, long k, double x) {
  const double part = (x - a->x[k]) / (a->x[k + 1] - a->x[k]);
  return part >= 1 ? values[k + 1] : values[k] + part * (values[k + 1] - values[k]);
}

double first_reach_at(const first_reach *a, double x) {
  long below = -1, from = a->count; /* x[below] < x <= x[from] */
  while (from - below > 1) {
    const long middle = below + (from - below) / 2;
    if (a->x[middle] < x)
      below = middle;
    else
      from = middle;
  }
  if (!a->count) return NAN;
  if (from == a->count) return a->low[below];
  return below < 0 || a->x[from] == x ? a->low[from] : first_reach_between(a, a->low, below, x);
}
