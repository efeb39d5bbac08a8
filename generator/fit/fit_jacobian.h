/* The derivatives of residuals by the parameters, by central differences, and their singular
   values. Parameters are taken over the widths of their bounds: all have one scale. */
#ifndef PERILAT_GENERATOR_FIT_JACOBIAN_H
#define PERILAT_GENERATOR_FIT_JACOBIAN_H

#include "generator/fit/fit_search.h"

/* All parameters, or some. */
typedef struct fit_set {
  int index[FIT_MOST], count;
} fit_set;

fit_set fit_set_all(const fit_problem *p);
double fit_width(const fit_parameter *p);

/* J by columns, [parameters*residuals], at a point with its residuals: the slope of the parabola
   through it and two points a step beside it, over the width (both on one side, near a bound). In
   one batch of 2*parameters points. The caller frees it; NULL where the batch fails. */
double *fit_jacobian(const fit_problem *p, const double *point, const double *residuals,
                     double step);

typedef struct fit_singular {
  double value[FIT_MOST];            /* descending; 0 where there are fewer residuals */
  double vector[FIT_MOST][FIT_MOST]; /* vector[c][k]: component c of value k's */
} fit_singular;

/* Of the columns of J that belong to a set. False where LAPACK fails. */
bool fit_decompose(const double *j, int residuals, const fit_set *s, fit_singular *d);

#endif
