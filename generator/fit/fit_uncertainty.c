#include "generator/fit/fit_uncertainty.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "dsl/base/elementary.h"
#include "generator/fit/fit_jacobian.h"
#include "runtime/base/special_functions.h"

static const double step = 0.01;          /* of the width of the bounds */
static const double most_condition = 1e4; /* what differences of this step can show */
static const double least_part = 0.1;     /* of a combination, to be named */
static const double confidence = 0.95;

static fit_set judge_bounds(const fit_problem *p, const fit_found *f, fit_uncertainty *u) {
  fit_set s = {.count = 0};
  for (int i = 0; i < p->parameters; i++) {
    const fit_parameter *q = &p->parameter[i];
    const double near = p->tolerance * fit_width(q);
    u->verdict[i] = f->best[i] <= q->lower + near   ? FIT_AT_LOWER
                    : f->best[i] >= q->upper - near ? FIT_AT_UPPER
                                                    : FIT_TOLD;
    if (u->verdict[i] == FIT_TOLD) s.index[s.count++] = i;
  }
  return s;
}

/* --- what follows ----------------------------------------------------------------------------- */

/* A combination is weak where its interval is as wide as the bounds, or less sure than what
   differences can show. */
static void find_weak(const fit_singular *d, int n, double interval, fit_uncertainty *u) {
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
static double inverse(const fit_singular *d, int n, int a, int b) {
  double sum = 0;
  for (int k = 0; k < n; k++) {
    const double held = pl_fmax(d->value[k], 1e-14 * d->value[0]);
    sum += d->vector[a][k] / held * (d->vector[b][k] / held);
  }
  return sum;
}

static void fill(const fit_problem *p, const fit_found *f, const fit_set *s, const fit_singular *d,
                 double t, fit_uncertainty *u) {
  double root[FIT_MOST];
  for (int a = 0; a < s->count; a++) {
    const int i = s->index[a];
    root[a] = sqrt(inverse(d, s->count, a, a));
    u->error[i] = u->sigma * root[a] * fit_width(&p->parameter[i]);
    u->lower[i] = f->best[i] - t * u->error[i];
    u->upper[i] = f->best[i] + t * u->error[i];
  }
  for (int a = 0; a < s->count; a++)
    for (int b = 0; b < s->count; b++)
      u->correlation[s->index[a]][s->index[b]] =
          a == b ? 1 : inverse(d, s->count, a, b) / (root[a] * root[b]);
}

/* Weak combinations may hold parameters at bounds: they wander there. */
static bool judge(const fit_problem *p, const fit_found *f, const fit_set *inner, const double *j,
                  fit_uncertainty *u) {
  const int m = p->residuals, left = m - inner->count;
  const fit_set all = fit_set_all(p);
  fit_singular d;
  for (int i = 0; i < p->parameters; i++) {
    double sum = 0;
    for (int k = 0; k < m; k++)
      sum += j[i * (long)m + k] * j[i * (long)m + k];
    u->sensitivity[i] = sqrt(sum);
  }
  const double t = left > 0 ? special_student_quantile(confidence, left) : INFINITY;
  u->sigma = left > 0 ? sqrt(f->squares / left) : NAN;
  if (!fit_decompose(j, m, &all, &d)) return false;
  find_weak(&d, p->parameters, left > 0 ? t * u->sigma : INFINITY, u);
  if (!fit_decompose(j, m, inner, &d)) return false;
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
  const fit_set inner = judge_bounds(problem, found, u);
  double *j = fit_jacobian(problem, found->best, found->residuals, step);
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
