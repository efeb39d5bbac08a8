/* Functions of distributions and random fields beyond dsl/base/elementary.h, with the same bits on
   every processor. Largest errors measured, in ulp of the result: expm1 1.8, log1p 1.9, log_gamma
   3.7, gamma 6.2, normal_above 5.0; cosine_of_turns 2.7e-16, student_quantile 1e-12 of itself. */
#ifndef PERILAT_RUNTIME_SPECIAL_FUNCTIONS_H
#define PERILAT_RUNTIME_SPECIAL_FUNCTIONS_H

#include "dsl/base/elementary.h"

/* exp(x) - 1 and log(1 + x) without cancellation near 0. */
double special_expm1(double x);
double special_log1p(double x);

/* Gamma(1 + x) and its logarithm, x >= 0; infinite from x = 170.6 on. */
double special_gamma(double x);
double special_log_gamma(double x);

/* Probability that a standard normal number is more than z. */
double special_normal_above(double z);

/* How far from 0 a number of Student's distribution lies with probability `inside`, for 1 degree of
   freedom or more; from a million on, that of a million (3e-6 apart). */
double special_student_quantile(double inside, long freedom);

/* cos(2 pi x), |x| < 2^51. Without fused multiply-adds, so that loops over it are fast on every
   processor. Fit of sin(2 pi h)/h in h^2, |h| <= 1/4. */
PL_ELEMENTARY double special_cosine_of_turns(double x) {
  const double turn = x - ((x + PL_ROUNDER) - PL_ROUNDER);
  const double h = 0.25 - pl_abs(turn), z = h * h;
  double p = 0x1.8f9e5a085c7aap-4;
  p = p * z - 0x1.6f0536efc7126p-1;
  p = p * z + 0x1.e8f023f73b57cp+1;
  p = p * z - 0x1.e30741a6ba9a8p+3;
  p = p * z + 0x1.5078346ab756fp+5;
  p = p * z - 0x1.32d2cce5e66ebp+6;
  p = p * z + 0x1.466bc67759fccp+6;
  p = p * z - 0x1.4abbce625be39p+5;
  p = p * z + 0x1.921fb54442d18p+2;
  return h * p;
}

#endif
