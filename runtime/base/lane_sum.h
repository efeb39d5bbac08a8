/* Sums over arrays in an order of their own, the same whatever the vector width: PL_LANES lanes,
   then their sum. `count` is a multiple of PL_LANES. */
#ifndef PERILAT_RUNTIME_LANE_SUM_H
#define PERILAT_RUNTIME_LANE_SUM_H

/* Before a loop whose turns do not read what others write, so that it is done in vectors. */
#if defined(__clang__)
#define INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define INDEPENDENT _Pragma("GCC ivdep")
#endif

/* Sum of a. */
double lane_total(long count, const double *a);
/* Sums of weight a b and of weight (a + b)^2; without weights (NULL) they count as 1. */
double lane_dot(long count, const double *weight, const double *a, const double *b);
double lane_square(long count, const double *weight, const double *a, const double *b);

#endif
