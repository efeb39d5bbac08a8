/* Residuals of a computed curve y(x) at measured points, as numbers without unit that a fit makes
   small: y - measured over the largest measured value. Against a band they are taken from its
   middle, and a point counts as much more as the band is narrower there than in the mean. Each
   curve counts the same times its weight, whatever the number of its points: the sum of squares is
   the weighted mean square. */
#ifndef PERILAT_GENERATOR_FIT_CURVE_H
#define PERILAT_GENERATOR_FIT_CURVE_H

#include <stdbool.h>

#include "generator/results/first_reach.h"

typedef struct fit_curve {
  double *x, *y, *factor; /* [count]; factor: of y - measured */
  double along;           /* 1 where x goes up, else -1 */
  double failed;          /* size of all residuals of a run that failed */
  long count;             /* of residuals: points that are numbers */
} fit_curve;

/* Points count whose x goes farther than that of all before. False, with nothing to free, where no
   point is a number or all are 0. */
bool fit_curve_begin(fit_curve *c, const curve_points *measured, double weight);
void fit_curve_free(fit_curve *c);

/* The first time counts that the curve reaches each x. Where it ends before, its last value stands;
   its first one where it begins later. A curve without numbers has failed. */
void fit_curve_residuals(const fit_curve *c, const double *x, const double *y, long count,
                         double *residuals);
/* Of a run that failed: finite, and ten times the largest measured value off. */
void fit_curve_failed(const fit_curve *c, double *residuals);

#endif
