/* What two readers of one law wrote, value by value: how far apart, and what was left unwritten. */
#ifndef PERILAT_GENERATOR_COMPARISON_H
#define PERILAT_GENERATOR_COMPARISON_H

typedef struct comparison {
  long values;                /* compared */
  double largest_ulps;        /* infinite where one is NaN or infinite and the other is not */
  char worst[80];             /* where that was, e.g. "rows_ledger: force 2" */
  double kernel, interpreter; /* what they wrote there */
  long unwritten;             /* outputs that a reader left as they were */
  long misplaced;             /* values changed where nothing may change, e.g. of an absent bond */
} comparison;

/* Distance in units in the last place of the larger; 0 for equal (also NaN and NaN, 0 and -0). */
double ulps_between(double a, double b);

/* Compares `count` values of the output `what` (and its number, unless negative) of `pass`. */
void comparison_add(comparison *c, const char *pass, const char *what, int number,
                    const double *kernel, const double *interpreter, long count);

/* `planes` aligned arrays of `count` zeros each. */
double **planes_new(int planes, long count);
void planes_free(double **p, int planes);
/* Fills them with a NaN that no operation gives: what still holds it was not written. */
void planes_poison(double *const *p, int planes, long count);

#endif
