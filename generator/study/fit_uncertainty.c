#include "generator/study/fit_uncertainty.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/special_functions.h"

/* LAPACK: singular values, descending, and vectors of a matrix by columns. The last two arguments
   are the hidden text lengths. */
void dgesvd_(const char *left, const char *right, const int *rows, const int *columns, double *a,
             const int *lda, double *values, double *u, const int *ldu, double *vt, const int *ldvt,
             double *work, const int *work_size, int *info, size_t left_length,
             size_t right_length);

static const double step = 0.01;          /* of the width of the bounds */
static const double most_condition = 1e4; /* what differences of this step can show */
static const double least_part = 0.1;     /* of a combination, to be named */
static const double confidence = 0.95;

/* All parameters, or those that are not at a bound. */
typedef struct parameter_set {
  int index[FIT_MOST], count;
} parameter_set;

static double width_of(const fit_parameter *p) {
  return p->upper - p->lower;
}

static parameter_set all_of(const fit_problem *p) {
  parameter_set s = {.count = p->parameters};
  for (int i = 0; i < p->parameters; i++)
    s.index[i] = i;
  return s;
}

static parameter_set judge_bounds(const fit_problem *p, const fit_found *f, fit_uncertainty *u) {
  parameter_set s = {.count = 0};
  for (int i = 0; i < p->parameters; i++) {
    const fit_parameter *q = &p->parameter[i];
    const double near = p->tolerance * width_of(q);
    u->verdict[i] = f->best[i] <= q->lower + near   ? FIT_AT_LOWER
                    : f->best[i] >= q->upper - near ? FIT_AT_UPPER
                                                    : FIT_TOLD;
    if (u->verdict[i] == FIT_TOLD) s.index[s.count++] = i;
  }
  return s;
}

/* --- derivatives ------------------------------------------------------------------------------ */

/* Steps of the two points beside the best: one to each side, or both away from a bound. */
static void steps_of(const fit_parameter *q, double value, double by[2]) {
  const double h = step * width_of(q);
  by[0] = -h;
  by[1] = h;
  if (value - h < q->lower) by[0] = 2 * h;
  if (value + h > q->upper) by[1] = -2 * h;
}

/* The derivative at the best of the parabola through it and both points, times the width. */
static void differentiate(const fit_parameter *q, double value, const double *at, const double *r,
                          int m, double *column) {
  double by[2];
  steps_of(q, value, by);
  const double a = by[0] / width_of(q), b = by[1] / width_of(q);
  for (int k = 0; k < m; k++) {
    const double to_a = (r[k] - at[k]) / a, to_b = (r[m + k] - at[k]) / b;
    column[k] = (b * to_a - a * to_b) / (b - a);
  }
}

/* J by columns, over the widths of the bounds. NULL where a run fails. */
static double *jacobian(const fit_problem *p, const fit_found *f) {
  const size_t n = (size_t)p->parameters, m = (size_t)p->residuals;
  double *place = must_alloc(2 * n * n * sizeof(double));
  double *r = must_alloc(2 * n * m * sizeof(double)), *j = must_alloc(n * m * sizeof(double));
  for (size_t k = 0; k < 2 * n; k++) {
    const size_t i = k / 2;
    double by[2];
    steps_of(&p->parameter[i], f->best[i], by);
    memcpy(&place[k * n], f->best, n * sizeof(double));
    place[k * n + i] += by[k % 2];
  }
  const bool good = p->evaluate(p->context, place, (int)(2 * n), r);
  for (size_t i = 0; i < n && good; i++)
    differentiate(&p->parameter[i], f->best[i], f->residuals, &r[2 * i * m], p->residuals,
                  &j[i * m]);
  free(place);
  free(r);
  if (good) return j;
  free(j);
  return NULL;
}

/* --- what follows ----------------------------------------------------------------------------- */

typedef struct singular {
  double value[FIT_MOST], vector[FIT_MOST][FIT_MOST]; /* vector[c][k]: component c of value k's */
} singular;

/* Of the columns of J that belong to a set; values are 0 where there are fewer residuals. */
static bool decompose(const double *j, int m, const parameter_set *s, singular *d) {
  const int one = 1, n = s->count, most = FIT_MOST, work_size = 64 * FIT_MOST + 2 * m;
  int info = 0;
  *d = (singular){.value = {0}};
  if (!n) return true;
  double *columns = must_alloc((size_t)n * (size_t)m * sizeof(double));
  double *work = must_alloc((size_t)work_size * sizeof(double));
  for (int a = 0; a < n; a++)
    memcpy(&columns[(size_t)a * (size_t)m], &j[(size_t)s->index[a] * (size_t)m],
           (size_t)m * sizeof(double));
  dgesvd_("N", "A", &m, &n, columns, &m, d->value, NULL, &one, &d->vector[0][0], &most, work,
          &work_size, &info, 1, 1);
  free(columns);
  free(work);
  return info == 0;
}

/* A combination is weak where its interval is as wide as the bounds, or less sure than what
   differences can show. */
static void find_weak(const singular *d, int n, double interval, fit_uncertainty *u) {
  u->condition = d->value[0] / d->value[n - 1];
  for (int k = 0; k < n; k++) {
    if (d->value[k] * most_condition > d->value[0] && interval < 0.5 * d->value[k]) continue;
    double *way = u->way[u->weak++];
    for (int i = 0; i < n; i++) {
      way[i] = d->vector[i][k];
      if (fabs(way[i]) >= least_part && u->verdict[i] == FIT_TOLD) u->verdict[i] = FIT_UNTOLD;
    }
  }
}

/* (J'J)^-1, of singular values no less than what rounding leaves of them. */
static double inverse(const singular *d, int n, int a, int b) {
  double sum = 0;
  for (int k = 0; k < n; k++) {
    const double held = pl_fmax(d->value[k], 1e-14 * d->value[0]);
    sum += d->vector[a][k] / held * (d->vector[b][k] / held);
  }
  return sum;
}

static void fill(const fit_problem *p, const fit_found *f, const parameter_set *s,
                 const singular *d, double t, fit_uncertainty *u) {
  double root[FIT_MOST];
  for (int a = 0; a < s->count; a++) {
    const int i = s->index[a];
    root[a] = sqrt(inverse(d, s->count, a, a));
    u->error[i] = u->sigma * root[a] * width_of(&p->parameter[i]);
    u->lower[i] = f->best[i] - t * u->error[i];
    u->upper[i] = f->best[i] + t * u->error[i];
  }
  for (int a = 0; a < s->count; a++)
    for (int b = 0; b < s->count; b++)
      u->correlation[s->index[a]][s->index[b]] =
          a == b ? 1 : inverse(d, s->count, a, b) / (root[a] * root[b]);
}

/* Weak combinations may hold parameters at bounds: they wander there. */
static bool judge(const fit_problem *p, const fit_found *f, const parameter_set *inner,
                  const double *j, fit_uncertainty *u) {
  const int m = p->residuals, left = m - inner->count;
  const parameter_set all = all_of(p);
  singular d;
  for (int i = 0; i < p->parameters; i++) {
    double sum = 0;
    for (int k = 0; k < m; k++)
      sum += j[i * (long)m + k] * j[i * (long)m + k];
    u->sensitivity[i] = sqrt(sum);
  }
  const double t = left > 0 ? special_student_quantile(confidence, left) : INFINITY;
  u->sigma = left > 0 ? sqrt(f->squares / left) : NAN;
  if (!decompose(j, m, &all, &d)) return false;
  find_weak(&d, p->parameters, left > 0 ? t * u->sigma : INFINITY, u);
  if (!decompose(j, m, inner, &d)) return false;
  if (left > 0 && d.value[0] > 0) fill(p, f, inner, &d, t, u);
  return true;
}

bool fit_uncertainty_find(const fit_problem *problem, const fit_found *found, fit_uncertainty *u) {
  *u = (fit_uncertainty){.sigma = NAN, .condition = NAN};
  for (int i = 0; i < FIT_MOST; i++) {
    u->sensitivity[i] = u->error[i] = u->lower[i] = u->upper[i] = NAN;
    for (int k = 0; k < FIT_MOST; k++)
      u->correlation[i][k] = NAN;
  }
  const parameter_set inner = judge_bounds(problem, found, u);
  double *j = jacobian(problem, found);
  u->runs = 2 * problem->parameters;
  const bool good = j && judge(problem, found, &inner, j, u);
  free(j);
  return good;
}

/* The other parameters of the first weak combination that has this one, each with its sign against
   it. */
static void name_others(const fit_problem *p, const fit_uncertainty *u, int parameter, FILE *out) {
  for (int k = 0; k < u->weak; k++) {
    const double own = u->way[k][parameter];
    int others = 0;
    if (fabs(own) < least_part) continue;
    for (int i = 0; i < p->parameters; i++) {
      if (i == parameter || fabs(u->way[k][i]) < least_part) continue;
      fprintf(out, "%s `%s`, %s", others++ ? " and" : "; a change is made up for by",
              p->parameter[i].name,
              own * u->way[k][i] > 0 ? "rising with it" : "falling as it rises");
    }
    return;
  }
}

void fit_verdict_text(const fit_problem *problem, const fit_uncertainty *u, int parameter,
                      char *text, size_t size) {
  const fit_verdict verdict = u->verdict[parameter];
  FILE *out = fmemopen(text, size, "w");
  *text = 0;
  if (!out) return;
  if (verdict == FIT_AT_LOWER) fputs("at its lower bound", out);
  if (verdict == FIT_AT_UPPER) fputs("at its upper bound", out);
  if (verdict == FIT_UNTOLD) fputs("cannot be told from the data", out);
  if (verdict == FIT_UNTOLD) name_others(problem, u, parameter, out);
  fclose(out);
}
