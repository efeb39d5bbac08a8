/* Parameters within bounds for which the sum of squares of residuals is least, found without
   derivatives by NLopt (Johnson, 2007): BOBYQA (Powell 2009), or Nelder and Mead's simplex (1965;
   bounds as Box 1965). Runs are asked for in batches, whose runs may be done at the same time. The
   same residuals give the same search, to the bit. */
#ifndef PERILAT_GENERATOR_FIT_SEARCH_H
#define PERILAT_GENERATOR_FIT_SEARCH_H

#include <stdbool.h>

enum { FIT_MOST = 16 }; /* parameters */

typedef struct fit_parameter {
  const char *name;
  double lower, upper, start; /* lower < upper, start between or at them; finite */
} fit_parameter;

/* Residuals of `count` points: point k is points[k*parameters], its residuals are
   residuals[k*residuals of the problem]. All finite; a run that failed has large ones. False: the
   search cannot go on. */
typedef bool fit_evaluate(void *context, const double *points, int count, double *residuals);

typedef enum fit_method { FIT_BOBYQA, FIT_NELDER_MEAD } fit_method;

typedef struct fit_problem {
  const fit_parameter *parameter;
  int parameters, residuals;
  fit_evaluate *evaluate;
  void *context;
  fit_method method;
  double tolerance; /* of each parameter, over the width of its bounds */
  int most_runs;    /* of the search; at least 2*parameters + 2 */
} fit_problem;

typedef enum fit_end {
  FIT_FOUND,  /* to the tolerance */
  FIT_LIMIT,  /* the runs were used up */
  FIT_BROKEN, /* a batch failed, or a residual was not finite */
} fit_end;

typedef struct fit_found {
  fit_end end;
  double best[FIT_MOST];
  double squares;    /* sum of squares at the best */
  double *residuals; /* there; NULL where nothing was computed */
  int runs;          /* distinct points computed */
} fit_found;

void fit_search(const fit_problem *problem, fit_found *found);
void fit_found_free(fit_found *found);

#endif
