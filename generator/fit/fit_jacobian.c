#include "generator/fit/fit_jacobian.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

/* LAPACK: singular values, descending, and vectors of a matrix by columns. The last two arguments
   are the hidden text lengths. */
void dgesvd_(const char *left, const char *right, const int *rows, const int *columns, double *a,
             const int *lda, double *values, double *u, const int *ldu, double *vt, const int *ldvt,
             double *work, const int *work_size, int *info, size_t left_length,
             size_t right_length);

fit_set fit_set_all(const fit_problem *p) {
  fit_set s = {.count = p->parameters};
  for (int i = 0; i < p->parameters; i++)
    s.index[i] = i;
  return s;
}

double fit_width(const fit_parameter *p) {
  return p->upper - p->lower;
}

/* Steps of the two points beside: one to each side, or both away from a bound. */
static void steps_of(const fit_parameter *q, double value, double step, double by[2]) {
  const double h = step * fit_width(q);
  by[0] = -h;
  by[1] = h;
  if (value - h < q->lower) by[0] = 2 * h;
  if (value + h > q->upper) by[1] = -2 * h;
}

/* The derivative at the point of the parabola through it and both others, times the width. */
static void differentiate(const fit_parameter *q, double value, double step, const double *at,
                          const double *r, int m, double *column) {
  double by[2];
  steps_of(q, value, step, by);
  const double a = by[0] / fit_width(q), b = by[1] / fit_width(q);
  for (int k = 0; k < m; k++) {
    const double to_a = (r[k] - at[k]) / a, to_b = (r[m + k] - at[k]) / b;
    column[k] = (b * to_a - a * to_b) / (b - a);
  }
}

double *fit_jacobian(const fit_problem *p, const double *point, const double *residuals,
                     double step) {
  const size_t n = (size_t)p->parameters, m = (size_t)p->residuals;
  double *place = must_alloc(2 * n * n * sizeof(double));
  double *r = must_alloc(2 * n * m * sizeof(double)), *j = must_alloc(n * m * sizeof(double));
  for (size_t k = 0; k < 2 * n; k++) {
    const size_t i = k / 2;
    double by[2];
    steps_of(&p->parameter[i], point[i], step, by);
    memcpy(&place[k * n], point, n * sizeof(double));
    place[k * n + i] += by[k % 2];
  }
  const bool good = p->evaluate(p->context, place, (int)(2 * n), r);
  for (size_t i = 0; i < n && good; i++)
    differentiate(&p->parameter[i], point[i], step, residuals, &r[2 * i * m], p->residuals,
                  &j[i * m]);
  free(place);
  free(r);
  if (good) return j;
  free(j);
  return NULL;
}

bool fit_decompose(const double *j, int residuals, const fit_set *s, fit_singular *d) {
  const int one = 1, n = s->count, most = FIT_MOST, work_size = 64 * FIT_MOST + 2 * residuals;
  const size_t m = (size_t)residuals;
  int info = 0;
  *d = (fit_singular){.value = {0}};
  if (!n) return true;
  double *columns = must_alloc((size_t)n * m * sizeof(double));
  double *work = must_alloc((size_t)work_size * sizeof(double));
  for (int a = 0; a < n; a++)
    memcpy(&columns[(size_t)a * m], &j[(size_t)s->index[a] * m], m * sizeof(double));
  dgesvd_("N", "A", &residuals, &n, columns, &residuals, d->value, NULL, &one, &d->vector[0][0],
          &most, work, &work_size, &info, 1, 1);
  free(columns);
  free(work);
  return info == 0;
}
