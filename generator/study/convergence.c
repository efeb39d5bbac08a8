#include "generator/study/convergence.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/special_functions.h"

static const double same = 1e-6; /* values that differ by less, relative to them, are the same */
static const double least_order = 0.5, proper_order = 2.1, most_order = 4;
static const double lowest = -8, highest = 24; /* orders that are looked for */
enum { STEPS = 320, UNKNOWNS = 3 };

/* Sizes from the coarsest to the finest. */
typedef struct sequence {
  const convergence_level **level;
  double *h, *mean;               /* h over the finest */
  double *fit_weight;             /* sum: count */
  int count, runs;                /* sizes, values at each */
  const convergence_level *first; /* as given: knows what its runs share */
  double range;                   /* of the means */
} sequence;

static int coarser(const void *a, const void *b) {
  const double x = (*(const convergence_level *const *)a)->size,
               y = (*(const convergence_level *const *)b)->size;
  return (x < y) - (x > y);
}

static void say(convergence *c, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void say(convergence *c, const char *format, ...) {
  va_list given;
  va_start(given, format);
  vsnprintf(c->reason, sizeof c->reason, format, given);
  va_end(given);
}

static double mean_of(const double *values, int count) {
  double sum = 0;
  for (int k = 0; k < count; k++)
    sum += values[k];
  return sum / count;
}

static sequence sequence_new(const convergence_level *levels, int count) {
  sequence s = {.count = count, .runs = levels[0].count, .first = levels};
  s.level = must_alloc((size_t)count * sizeof *s.level);
  double **columns[] = {&s.h, &s.mean, &s.fit_weight};
  for (int c = 0; c < 3; c++)
    *columns[c] = must_alloc((size_t)count * sizeof(double));
  for (int k = 0; k < count; k++)
    s.level[k] = &levels[k];
  qsort(s.level, (size_t)count, sizeof *s.level, coarser);
  double low = INFINITY, high = -INFINITY;
  for (int k = 0; k < count; k++) {
    s.h[k] = s.level[k]->size / s.level[count - 1]->size;
    s.mean[k] = mean_of(s.level[k]->values, s.runs);
    low = pl_fmin(low, s.mean[k]);
    high = pl_fmax(high, s.mean[k]);
  }
  s.range = high - low;
  return s;
}

static void sequence_free(sequence *s) {
  free(s->level);
  free(s->h);
  free(s->mean);
  free(s->fit_weight);
}

/* --- the fit ---------------------------------------------------------------------------------- */

/* (h^p - 1)/p, which goes on smoothly through p = 0, and its derivative by p. */
static double power(double h, double p) {
  const double l = pl_log(h);
  return fabs(p * l) < 1e-9 ? l * (1 + p * l / 2) : special_expm1(p * l) / p;
}

static double power_slope(double h, double p) {
  const double l = pl_log(h), z = p * l;
  if (fabs(z) < 1e-4) return l * l * (0.5 + z / 3 + z * z / 8);
  return (l * pl_exp(z) - special_expm1(z) / p) / p;
}

typedef struct fit { /* Q = finest + slope power(h, order) */
  double order, finest, slope;
  double squares; /* weighted sum of them */
  double sigma;   /* standard deviation */
} fit;

/* Straight line over power(h, p). */
static fit fit_of_order(const sequence *s, double p) {
  double sum = 0, x0 = 0, y0 = 0, xx = 0, xy = 0;
  for (int k = 0; k < s->count; k++) {
    sum += s->fit_weight[k];
    x0 += s->fit_weight[k] * power(s->h[k], p);
    y0 += s->fit_weight[k] * s->mean[k];
  }
  x0 /= sum;
  y0 /= sum;
  for (int k = 0; k < s->count; k++) {
    const double x = power(s->h[k], p) - x0;
    xx += s->fit_weight[k] * x * x;
    xy += s->fit_weight[k] * x * (s->mean[k] - y0);
  }
  fit f = {.order = p, .slope = xy / xx};
  f.finest = y0 - f.slope * x0;
  for (int k = 0; k < s->count; k++) {
    const double r = s->mean[k] - f.finest - f.slope * power(s->h[k], p);
    f.squares += s->fit_weight[k] * r * r;
  }
  return f;
}

/* Falls through 0 where the sum of squares is least. */
static double rise_of_squares(const sequence *s, double p) {
  const fit f = fit_of_order(s, p);
  double sum = 0;
  for (int k = 0; k < s->count; k++) {
    const double r = s->mean[k] - f.finest - f.slope * power(s->h[k], p);
    sum -= s->fit_weight[k] * r * f.slope * power_slope(s->h[k], p);
  }
  return sum;
}

/* The best of orders on a grid, then halved down to the bit. */
static fit fit_with_order(const sequence *s) {
  const double step = (highest - lowest) / STEPS;
  int best = 0;
  double least = INFINITY;
  for (int k = 0; k <= STEPS; k++) {
    const double squares = fit_of_order(s, lowest + k * step).squares;
    if (squares < least) least = squares, best = k;
  }
  double low = lowest + (best - 1) * step, high = lowest + (best + 1) * step;
  for (int k = 0; k < 100; k++) {
    const double middle = 0.5 * (low + high);
    if (rise_of_squares(s, middle) > 0)
      high = middle;
    else
      low = middle;
  }
  return fit_of_order(s, 0.5 * (low + high));
}

static double sigma_of(const sequence *s, const fit *f, int unknowns) {
  return s->count > unknowns ? sqrt(f->squares / (s->count - unknowns)) : 0;
}

/* Equal weights, or 1/h. */
static void weigh(sequence *s, bool by_size) {
  double sum = 0;
  for (int k = 0; k < s->count; k++)
    sum += s->fit_weight[k] = by_size ? 1 / s->h[k] : 1;
  for (int k = 0; k < s->count; k++)
    s->fit_weight[k] *= s->count / sum;
}

static fit fit_weighed(sequence *s, bool by_size) {
  weigh(s, by_size);
  fit f = fit_with_order(s);
  f.sigma = sigma_of(s, &f, UNKNOWNS);
  return f;
}

/* The nearer of the two; leaves its weights behind. */
static fit fit_best(sequence *s) {
  const fit by_size = fit_weighed(s, true), equal = fit_weighed(s, false);
  if (equal.sigma <= by_size.sigma) return equal;
  weigh(s, true);
  return by_size;
}

static double limit_of(const fit *f) {
  return f->finest - f->slope / f->order;
}

/* --- verdicts --------------------------------------------------------------------------------- */

static bool levels_are_good(const convergence_level *levels, int count, convergence *c) {
  for (int k = 0; k < count; k++) {
    const convergence_level *l = &levels[k];
    int good = 0;
    for (int i = 0; i < l->count; i++)
      good += isfinite(l->values[i]) != 0;
    if (good < l->count || l->count < 1)
      say(c, "a run at %s has no value", l->name);
    else if (l->count != levels[0].count)
      say(c, "%s has %d values and %s has %d", levels[0].name, levels[0].count, l->name, l->count);
    else if (!(l->size > 0 && isfinite(l->size)))
      say(c, "%s is no size: it must be more than 0", l->name);
    for (int i = 0; i < k && !*c->reason; i++)
      if (levels[i].size == l->size) say(c, "%s and %s are the same size", levels[i].name, l->name);
    if (*c->reason) return false;
  }
  if (count < 3) say(c, "%d size%s of 3 at least; add finer ones", count, count == 1 ? "" : "s");
  return count >= 3;
}

/* Standard error of a mean, for values[0..count). */
static double standard_error(const double *values, int count) {
  const double mean = mean_of(values, count);
  double sum = 0;
  for (int k = 0; k < count; k++)
    sum += (values[k] - mean) * (values[k] - mean);
  return count > 1 ? sqrt(sum / (count - 1) / count) : 0;
}

/* Of a mean of independent draws: its standard error, and half of its 95 % interval. */
typedef struct spread {
  double error, interval;
} spread;

static spread spread_of(const double *draws, int count) {
  const double error = standard_error(draws, count);
  return (spread){error, count > 1 ? special_student_quantile(0.95, count - 1) * error : 0};
}

static void widen(spread *s, spread other) {
  s->error = pl_fmax(s->error, other.error);
  s->interval = pl_fmax(s->interval, other.interval);
}

/* Means over the runs that share a value of a key; returns how many there are. */
static int means_of_shared(const double *sums, const int *shared, int runs, double *means) {
  int count = 0;
  for (int value = 0, among = 1; among > 0; value++) {
    double sum = 0;
    among = 0;
    for (int i = 0; i < runs; i++)
      if (shared[i] == value) sum += sums[i], among++;
    if (among > 0) means[count++] = sum / among;
  }
  return count;
}

/* Of what is a sum of the values at all sizes, with a factor each. */
static spread spread_of_sum(const sequence *s, const double *factor) {
  double *sums = must_calloc((size_t)s->runs, sizeof(double)),
         *means = must_alloc((size_t)s->runs * sizeof(double));
  for (int i = 0; i < s->runs; i++)
    for (int k = 0; k < s->count; k++)
      sums[i] += factor[k] * s->level[k]->values[i];
  spread widest = spread_of(sums, s->runs);
  for (int k = 0; k < s->first->shared_count; k++)
    widen(&widest, spread_of(means, means_of_shared(sums, s->first->shared[k], s->runs, means)));
  free(means);
  free(sums);
  return widest;
}

static bool scatter_hides_change(const sequence *s, convergence *c) {
  const int n = s->count;
  double *factor = must_calloc((size_t)n, sizeof(double));
  factor[n - 2] = -1;
  factor[n - 1] = 1;
  const double change = fabs(s->mean[n - 1] - s->mean[n - 2]),
               error = spread_of_sum(s, factor).error;
  free(factor);
  if (s->runs < 2 || change > error) return false;
  say(c,
      "the %d orientations or seeds scatter as much as the sizes differ: from %s to %s their mean "
      "changes by %.3g, with a standard error of %.3g",
      s->runs, s->level[n - 2]->name, s->level[n - 1]->name, change, error);
  return true;
}

/* Of three sizes none may go against the others; of more, noise may by half of a mean change. */
static bool oscillates(const sequence *s, convergence *c) {
  const double along = s->mean[s->count - 1] >= s->mean[0] ? 1 : -1;
  const double allowed = s->count > 3 ? 0.5 * s->range / (s->count - 1) : 0;
  for (int k = 0; k + 1 < s->count; k++) {
    const double change = s->mean[k + 1] - s->mean[k];
    if (-along * change <= allowed) continue;
    say(c,
        "the change of the value changes sign between sizes (%+.3g from %s to %s): it oscillates",
        change, s->level[k]->name, s->level[k + 1]->name);
    return true;
  }
  return false;
}

static bool order_is_good(const sequence *s, double order, convergence *c) {
  const char *finest = s->level[s->count - 1]->name, *before = s->level[s->count - 2]->name;
  if (!(order > 1e-6))
    say(c, "the changes from size to size do not fall: order %.2g, no limit", order);
  else if (order < least_order)
    say(c, "the changes fall too slowly for a limit: order %.2g, less than %g", order, least_order);
  else if (order > most_order)
    say(c,
        "from %s to %s it changes much less than before (order %.2g, more than %g): coarser sizes "
        "do not belong to the series; add finer ones",
        before, finest, pl_fmin(order, 99), most_order);
  return !*c->reason;
}

/* --- the bar ---------------------------------------------------------------------------------- */

/* Solves a x = b, symmetric and positive, of order n. */
static void solve(int n, double a[UNKNOWNS][UNKNOWNS], double x[UNKNOWNS]) {
  for (int k = 0; k < n; k++)
    for (int i = k + 1; i < n; i++) {
      const double part = a[i][k] / a[k][k];
      for (int j = k; j < n; j++)
        a[i][j] -= part * a[k][j];
      x[i] -= part * x[k];
    }
  for (int i = n - 1; i >= 0; i--) {
    for (int j = i + 1; j < n; j++)
      x[i] -= a[i][j] * x[j];
    x[i] /= a[i][i];
  }
}

/* What the fit changes by with finest, slope and, where it is free, order. */
static void basis(const sequence *s, const fit *f, int k, double row[UNKNOWNS]) {
  row[0] = 1;
  row[1] = power(s->h[k], f->order);
  row[2] = power_slope(s->h[k], f->order) / pl_fmax(power(s->h[0], f->order), 1e-300);
}

/* How the limit, finest - slope/order, changes with the value at each size (delta method): the
   normal equations with the limit's derivatives on the right. */
static void limit_factors(const sequence *s, const fit *f, bool order_is_free, double *factor) {
  const int n = order_is_free ? 3 : 2;
  const double scale = pl_fmax(power(s->h[0], f->order), 1e-300), p = f->order;
  double a[UNKNOWNS][UNKNOWNS] = {{0}}, x[UNKNOWNS] = {1, -1 / p, 1 / (p * p * scale)};
  for (int k = 0; k < s->count; k++) {
    double row[UNKNOWNS];
    basis(s, f, k, row);
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n; j++)
        a[i][j] += s->fit_weight[k] * row[i] * row[j];
  }
  solve(n, a, x);
  for (int k = 0; k < s->count; k++) {
    double row[UNKNOWNS];
    basis(s, f, k, row);
    factor[k] = 0;
    for (int i = 0; i < n; i++)
      factor[k] += s->fit_weight[k] * row[i] * x[i];
  }
}

static void give(convergence *c, double value, double discretisation, double scatter) {
  c->converged = true;
  c->value = value;
  c->discretisation = discretisation;
  c->scatter = scatter;
  c->error = pl_hypot(discretisation, scatter);
}

static void same_at_all(const sequence *s, convergence *c) {
  double *factor = must_calloc((size_t)s->count, sizeof(double));
  factor[s->count - 1] = 1;
  give(c, s->mean[s->count - 1], 3 * s->range, spread_of_sum(s, factor).interval);
  say(c, "the same at all sizes: its order is unknown");
  free(factor);
}

static void bar_of(sequence *s, fit f, convergence *c) {
  const int last = s->count - 1;
  const bool proper = f.order <= proper_order;
  if (!proper) {
    f = fit_of_order(s, 2);
    f.sigma = sigma_of(s, &f, UNKNOWNS - 1);
  }
  double *factor = must_alloc((size_t)s->count * sizeof(double));
  limit_factors(s, &f, proper, factor);
  const double limit = limit_of(&f), scatter = spread_of_sum(s, factor).interval;
  const double rest = fabs(s->mean[last] - f.finest);
  give(c, limit, (proper ? 1.25 : 3) * fabs(s->mean[last] - limit) + f.sigma + rest, scatter);
  free(factor);
}

static void judge(sequence *s, convergence *c) {
  const double size = pl_fmax(fabs(s->mean[0]), fabs(s->mean[s->count - 1]));
  if (s->range <= same * size) {
    same_at_all(s, c);
    return;
  }
  if (scatter_hides_change(s, c) || oscillates(s, c)) return;
  const fit f = fit_best(s);
  c->order = f.order;
  if (!order_is_good(s, f.order, c)) return;
  if (f.sigma < s->range / (s->count - 1)) {
    bar_of(s, f, c);
    return;
  }
  say(c,
      "the values scatter by %.3g about any Q0 + C h^p, as much as they change from size to size",
      f.sigma);
}

void convergence_find(const convergence_level *levels, int count, convergence *found) {
  *found = (convergence){
      .order = NAN, .value = NAN, .error = NAN, .discretisation = NAN, .scatter = NAN};
  if (!levels_are_good(levels, count, found)) return;
  sequence s = sequence_new(levels, count);
  judge(&s, found);
  sequence_free(&s);
}
