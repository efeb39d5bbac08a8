/* How well the data tell the parameters of a fit: sensitivities by central differences (a hundredth
   of the bounds' width), covariance s^2 (J'J)^-1 by singular values of J (Bates and Watts 1988,
   2.3), intervals by Student's t; which combination of parameters the data do not tell.

   The intervals take the residuals as independent. Those of a smooth curve that the law cannot
   follow are not: then the parameters are told less well than it says. */
#ifndef PERILAT_GENERATOR_FIT_UNCERTAINTY_H
#define PERILAT_GENERATOR_FIT_UNCERTAINTY_H

#include <stddef.h>

#include "generator/fit/fit_search.h"

typedef enum fit_verdict {
  FIT_TOLD,
  FIT_AT_LOWER, /* at a bound: the intervals of the others are those where it is held there */
  FIT_AT_UPPER,
  FIT_UNTOLD, /* the interval is as wide as the bounds, or a combination is not told */
} fit_verdict;

typedef struct fit_uncertainty {
  double sigma;                            /* standard deviation of the residuals */
  double sensitivity[FIT_MOST];            /* root of the sum of squares of the residuals' change
                                              with the parameter, over the width of its bounds */
  double error[FIT_MOST];                  /* standard error; NaN at a bound */
  double lower[FIT_MOST], upper[FIT_MOST]; /* 95 % interval, which may leave the bounds */
  double correlation[FIT_MOST][FIT_MOST];  /* NaN at a bound */
  fit_verdict verdict[FIT_MOST];
  double condition;               /* of J: its largest singular value over its least */
  int weak;                       /* combinations that are not told: */
  double way[FIT_MOST][FIT_MOST]; /* of each a unit vector, over the widths of the bounds */
  int runs;
} fit_uncertainty;

/* In one batch. False where that fails. */
bool fit_uncertainty_find(const fit_problem *problem, const fit_found *found, fit_uncertainty *u);

/* The verdict on a parameter in words; empty where it is told. */
void fit_verdict_text(const fit_problem *problem, const fit_uncertainty *u, int parameter,
                      char *text, size_t size);

#endif
