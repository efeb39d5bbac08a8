#include "generator/fit/fit_descent.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/fit/fit_jacobian.h"

static const double dampings[] = {0, 0.03, 0.1, 0.3}; /* over the largest singular value */
enum { TRIED = sizeof dampings / sizeof *dampings };
/* Of the differences, over the widths: the slope of a rough floor shows in the wide ones alone. */
static const double differences[] = {0.01, 0.05};
static const double least_gain = 0.01; /* of the sum of squares, to go on */

/* J'r, half the slope of the sum of squares. */
static void slope_of(const fit_problem *p, const double *j, const double *residuals,
                     double *slope) {
  for (int i = 0; i < p->parameters; i++) {
    slope[i] = 0;
    for (int k = 0; k < p->residuals; k++)
      slope[i] += j[i * (long)p->residuals + k] * residuals[k];
  }
}

/* Those at a bound that would leave it stay. */
static fit_set movable(const fit_problem *p, const double *at, const double *slope) {
  fit_set s = {.count = 0};
  for (int i = 0; i < p->parameters; i++) {
    const fit_parameter *q = &p->parameter[i];
    if (slope[i] > 0 ? at[i] > q->lower : at[i] < q->upper) s.index[s.count++] = i;
  }
  return s;
}

/* -(J'J + damping^2)^-1 J'r, cut off at the bounds. */
static void step_to(const fit_problem *p, const double *at, const fit_set *s, const fit_singular *d,
                    const double *slope, double damping, double *point) {
  const double most = d->value[0];
  memcpy(point, at, (size_t)p->parameters * sizeof(double));
  for (int a = 0; a < s->count; a++) {
    const fit_parameter *q = &p->parameter[s->index[a]];
    double by = 0;
    for (int k = 0; k < s->count; k++) {
      const double held = pl_fmax(d->value[k], 1e-8 * most), added = damping * most;
      double along = 0;
      for (int b = 0; b < s->count; b++)
        along += d->vector[b][k] * slope[s->index[b]];
      by -= d->vector[a][k] * along / (held * held + added * added);
    }
    const double value = at[s->index[a]] + by * fit_width(q);
    point[s->index[a]] = pl_fmin(pl_fmax(value, q->lower), q->upper);
  }
}

static double sum_of_squares(const double *r, int count) {
  double sum = 0;
  for (int k = 0; k < count; k++)
    sum += r[k] * r[k];
  return sum;
}

/* Whether the best of the points tried gains. */
static bool take_best(const fit_problem *p, fit_found *f, const double *points,
                      const double *residuals) {
  const size_t n = (size_t)p->parameters, m = (size_t)p->residuals;
  const double before = f->squares;
  for (size_t k = 0; k < TRIED; k++) {
    const double squares = sum_of_squares(&residuals[k * m], p->residuals);
    if (!(squares < f->squares)) continue;
    f->squares = squares;
    memcpy(f->best, &points[k * n], n * sizeof(double));
    memcpy(f->residuals, &residuals[k * m], m * sizeof(double));
  }
  return f->squares < (1 - least_gain) * before;
}

static bool try_steps(const fit_problem *p, fit_found *f, const double *j, double *points,
                      double *residuals) {
  double slope[FIT_MOST];
  fit_singular d;
  slope_of(p, j, f->residuals, slope);
  const fit_set s = movable(p, f->best, slope);
  if (!fit_decompose(j, p->residuals, &s, &d) || !(d.value[0] > 0)) return false;
  for (int k = 0; k < TRIED; k++)
    step_to(p, f->best, &s, &d, slope, dampings[k], &points[k * p->parameters]);
  f->runs += TRIED;
  if (p->evaluate(p->context, points, TRIED, residuals)) return take_best(p, f, points, residuals);
  f->end = FIT_BROKEN;
  return false;
}

static bool gains(const fit_problem *p, fit_found *f, double difference, double *points,
                  double *residuals) {
  const int wanted = 2 * p->parameters + TRIED;
  if (f->end != FIT_FOUND || f->squares == 0 || f->runs + wanted > p->most_runs) return false;
  double *j = fit_jacobian(p, f->best, f->residuals, difference);
  f->runs += 2 * p->parameters;
  if (!j) f->end = FIT_BROKEN;
  const bool gained = j && try_steps(p, f, j, points, residuals);
  free(j);
  return gained;
}

void fit_descend(const fit_problem *p, fit_found *f) {
  double *points = must_alloc(TRIED * (size_t)p->parameters * sizeof(double));
  double *residuals = must_alloc(TRIED * (size_t)p->residuals * sizeof(double));
  while (gains(p, f, differences[0], points, residuals) ||
         gains(p, f, differences[1], points, residuals))
    ;
  free(points);
  free(residuals);
}
