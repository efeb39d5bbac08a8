#include "runtime/base/lane_sum.h"

#include <stdbool.h>
#include <stddef.h>

#include "runtime/kernel.h"

/* Of eight lanes and 16 values: lane 0 has a[0] + a[8], lane 1 a[1] + a[9], ..., and the sum is
   ((lane 0 + lane 1) + lane 2) + ... Literal choices make vectors. */
static inline __attribute__((always_inline)) double
sum_products(long count, const double *restrict weight, const double *restrict a,
             const double *restrict b, bool square) {
  double lane[PL_LANES] = {0};
  for (long q = 0; q < count; q += PL_LANES)
    for (int l = 0; l < PL_LANES; l++) {
      const double both = a[q + l] + b[q + l], term = square ? both * both : a[q + l] * b[q + l];
      lane[l] += weight ? weight[q + l] * term : term;
    }
  double sum = 0;
  for (int l = 0; l < PL_LANES; l++)
    sum += lane[l];
  return sum;
}

double lane_dot(long count, const double *weight, const double *a, const double *b) {
  return weight ? sum_products(count, weight, a, b, false) : sum_products(count, NULL, a, b, false);
}

double lane_square(long count, const double *weight, const double *a, const double *b) {
  return weight ? sum_products(count, weight, a, b, true) : sum_products(count, NULL, a, b, true);
}

double lane_total(long count, const double *restrict a) {
  double lane[PL_LANES] = {0};
  for (long q = 0; q < count; q += PL_LANES)
    for (int l = 0; l < PL_LANES; l++)
      lane[l] += a[q + l];
  double sum = 0;
  for (int l = 0; l < PL_LANES; l++)
    sum += lane[l];
  return sum;
}
