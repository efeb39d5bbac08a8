#include "generator/fit/fit_curve.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

static const double failed_run = 10;   /* times the largest measured value */
static const double least_width = 0.1; /* of a band, over its mean: narrower counts no more */

static bool is_number(const curve_points *m, long k) {
  return isfinite(m->x[k]) && isfinite(m->low[k]) && isfinite(m->high[k]);
}

/* Goes farther than all before, as only the first time counts: marks of the points that do. */
static bool *first_points(const curve_points *m, double along) {
  bool *first = must_calloc((size_t)m->count + 1, sizeof *first);
  double reached = -INFINITY;
  for (long k = 0; k < m->count; k++) {
    if (!is_number(m, k) || !(along * m->x[k] > reached)) continue;
    first[k] = true;
    reached = along * m->x[k];
  }
  return first;
}

/* Half the width at a point over the mean one, or 1 where there is no band. */
static double relative_width(const curve_points *m, long k, double mean) {
  return mean > 0 ? pl_fmax(fabs(m->high[k] - m->low[k]) / mean, least_width) : 1;
}

bool fit_curve_begin(fit_curve *c, const curve_points *measured, double weight) {
  double largest = 0, width = 0;
  *c = (fit_curve){.along = first_reach_direction(measured, first_reach_x(measured, 0, 1))};
  bool *first = first_points(measured, c->along);
  for (long k = 0; k < measured->count; k++) {
    if (!first[k]) continue;
    c->count++;
    largest = pl_fmax(largest, pl_fmax(fabs(measured->low[k]), fabs(measured->high[k])));
    width += fabs(measured->high[k] - measured->low[k]);
  }
  if (!(largest > 0)) {
    free(first);
    return false;
  }
  double **columns[] = {&c->x, &c->y, &c->factor};
  for (int i = 0; i < 3; i++)
    *columns[i] = must_alloc((size_t)c->count * sizeof(double));
  const double all = sqrt(weight / (double)c->count), mean = width / (double)c->count;
  long n = 0;
  for (long k = 0; k < measured->count; k++) {
    if (!first[k]) continue;
    c->x[n] = measured->x[k];
    c->y[n] = 0.5 * (measured->low[k] + measured->high[k]);
    c->factor[n++] = all / (largest * relative_width(measured, k, mean));
  }
  c->failed = failed_run * all;
  free(first);
  return true;
}

void fit_curve_free(fit_curve *c) {
  free(c->x);
  free(c->y);
  free(c->factor);
  *c = (fit_curve){.count = 0};
}

void fit_curve_failed(const fit_curve *c, double *residuals) {
  for (long k = 0; k < c->count; k++)
    residuals[k] = c->failed;
}

void fit_curve_residuals(const fit_curve *c, const double *x, const double *y, long count,
                         double *residuals) {
  const curve_points computed = {x, y, y, count};
  first_reach reach = first_reach_of(&computed, c->along, false);
  if (!reach.count) fit_curve_failed(c, residuals);
  for (long k = 0; k < c->count && reach.count; k++)
    residuals[k] = c->factor[k] * (first_reach_at(&reach, c->along * c->x[k]) - c->y[k]);
  first_reach_free(&reach);
}
