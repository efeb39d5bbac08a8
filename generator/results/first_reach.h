/* A curve y(x), straight between its points, in the order in which x gets as far as it never was:
   where it comes back in x, the first time counts that it reaches each x. */
#ifndef PERILAT_GENERATOR_FIRST_REACH_H
#define PERILAT_GENERATOR_FIRST_REACH_H

#include <stdbool.h>

/* Points in the order in which they were taken; what is no number is left out. low and high are the
   same where there is no band. */
typedef struct curve_points {
  const double *x, *low, *high;
  long count;
} curve_points;

/* Ascending in x times the direction; equal x are a jump. */
typedef struct first_reach {
  double *x, *low, *high; /* [2*count] at most */
  long count;
} first_reach;

/* 1 where x goes farther up from `first` than down, else -1. */
double first_reach_direction(const curve_points *p, double first);
/* x of the first point from `from` on, by steps of 1 or -1; NaN where there is none. */
double first_reach_x(const curve_points *p, long from, long step);

/* `along` is 1 or -1, and what x is multiplied with; backwards: from the last point on. */
first_reach first_reach_of(const curve_points *p, double along, bool backwards);
void first_reach_free(first_reach *a);

/* The value at x (times the direction) of a column on the piece from point k to the next. */
double first_reach_between(const first_reach *a, const double *values, long k, double x);
/* The same of `low`, where x may lie anywhere: at a jump before it, beyond the ends as there. NaN
   of no points. */
double first_reach_at(const first_reach *a, double x);

#endif
