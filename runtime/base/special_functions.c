#include "runtime/base/special_functions.h"

#include <math.h>

/* Sum of coefficient[k] x^(count - 1 - k). */
static double polynomial(const double *coefficient, int count, double x) {
  double sum = coefficient[0];
  for (int k = 1; k < count; k++)
    sum = pl_fma(sum, x, coefficient[k]);
  return sum;
}
#define POLYNOMIAL(table, x) polynomial(table, (int)(sizeof table / sizeof *table), x)

/* exp(x) = 2^k (1 + q). */
double special_expm1(double x) {
  if (!(fabs(x) < 40)) return pl_exp(x) - 1;
  const double rounded = x * 0x1.71547652b82fep+0 + PL_ROUNDER, k = rounded - PL_ROUNDER;
  const double r = pl_fma(-k, PL_LN2_LO, pl_fma(-k, PL_LN2_HI, x)), scale = pl_two_to(rounded);
  return pl_fma(scale, pl_exp_reduced(r), scale - 1);
}

/* The rounding error of 1 + x falls out of the quotient (Kahan). */
double special_log1p(double x) {
  const double u = 1 + x;
  return u == 1 || u == INFINITY ? x : pl_log(u) * (x / (u - 1));
}

/* log Gamma(1 + x), 0 <= x <= 1, over its zeros x (x - 1): interpolation at Chebyshev's points, in
   x - 1/2. */
static double log_gamma_near(double x) {
  static const double fit[] = {
      0x1.8ca55ab6b8718p-17, -0x1.36d84fee907ffp-16, 0x1.c7d009a4fae3ap-17, -0x1.6880fac68f031p-16,
      0x1.672b94917149fp-15, -0x1.1cf3272629995p-14, 0x1.ba26ce28a34b0p-14, -0x1.61854b057e6e9p-13,
      0x1.1c7b46046a59cp-12, -0x1.cb502b140a127p-12, 0x1.750aa27fe4301p-11, -0x1.313e5323120b7p-10,
      0x1.f814b951d538bp-10, -0x1.a5035375acabep-9,  0x1.64f0664fb6518p-8,  -0x1.34dbda128eee5p-7,
      0x1.133423527ae27p-6,  -0x1.007aa83cef9abp-5,  0x1.01af62a2929e1p-4,  -0x1.2aed059bd6085p-3,
      0x1.eeb95b094c191p-2};
  return x * (x - 1) * POLYNOMIAL(fit, x - 0.5);
}

/* Gamma(1 + x) = product Gamma(1 + part), 0 <= part < 1. */
static double take_factors(double x, double *part) {
  double product = 1;
  *part = x - floor(x);
  for (double k = 1; k <= floor(x); k++)
    product *= *part + k;
  return product;
}

double special_gamma(double x) {
  double part;
  if (x > 170.6) return INFINITY;
  const double product = take_factors(x, &part);
  return product * pl_exp(log_gamma_near(part));
}

double special_log_gamma(double x) {
  double part;
  if (x > 170.6) return INFINITY;
  const double product = take_factors(x, &part);
  return pl_log(product) + log_gamma_near(part);
}

/* (1/2 - Q(z))/z for |z| <= 1: minimax fit in z^2. */
static double normal_between(double z) {
  static const double fit[] = {
      0x1.6fd5cfae8635dp-38, -0x1.00abb05086695p-33, 0x1.39ee4f0b8f96dp-29, -0x1.6242fe199fbb8p-25,
      0x1.658bcc4c29f1cp-21, -0x1.3ce9084a1fa38p-17, 0x1.e42b0dda7f580p-14, -0x1.37403f6d3c2eap-10,
      0x1.46d042976e6c7p-7,  -0x1.1058377e2cf61p-4,  0x1.9884533d43651p-2};
  return POLYNOMIAL(fit, z * z);
}

/* Q(z) = exp(-z^2/2) g/(1 + sqrt(2 pi) z) for z >= 1; g in (z - 5)/(z + 5) (after Shepherd and
   Laframboise 1981), interpolated at Chebyshev's points. */
static double normal_tail(double z) {
  static const double fit[] = {
      -0x1.7fe12e134e65dp-25, -0x1.93bbd82c691c8p-24, 0x1.bd6490cc9ff6bp-22, 0x1.716527795fc11p-21,
      -0x1.a62f19eb8765cp-19, -0x1.3cb011c86d96ap-19, 0x1.911141857acd7p-16, -0x1.f4998028ec920p-17,
      -0x1.43dd8b7ccb0f3p-13, 0x1.d53110590c0d8p-12,  0x1.0e86d456e4444p-13, -0x1.29cfc1ee107ebp-8,
      0x1.21461cfbbceefp-6,   -0x1.6320db40934fbp-5,  0x1.43a430e1e16b2p-4,  -0x1.c634be233c33ep-4,
      0x1.dabde3f926f1fp-4,   -0x1.2931588474cbdp-4,  -0x1.877579d4bb457p-6, 0x1.0a2f060b5dd53p+0};
  const double root_of_two_pi = 0x1.40d931ff62706p+1;
  const double held = z > 40 ? 40 : z; /* nothing is left there */
  const double square = held * held, rest = pl_fma(held, held, -square);
  const double g = POLYNOMIAL(fit, (held - 5) / (held + 5) - 0.0625);
  return pl_exp_sum(-0.5 * square, -0.5 * rest) * g / pl_fma(root_of_two_pi, held, 1);
}

double special_normal_above(double z) {
  if (fabs(z) < 1) return 0.5 - z * normal_between(z);
  return z < 0 ? 1 - normal_tail(-z) : normal_tail(z);
}

/* Probability of |t| < sqrt(freedom) tan(angle): Abramowitz and Stegun 1964, 26.7.3 and 26.7.4. */
static double student_inside(double angle, long freedom) {
  const double c = pl_cos(angle), odd = (double)(freedom % 2), half_turn = 0x1.921fb54442d18p+1;
  double term = odd == 1 ? c : 1, sum = freedom > 1 ? term : 0;
  for (double k = 2 + odd; k <= (double)freedom - 2; k += 2)
    sum += term *= (k - 1) / k * c * c;
  sum *= pl_sin(angle);
  return odd == 1 ? 2 / half_turn * (angle + sum) : sum;
}

double special_student_quantile(double inside, long freedom) {
  const long held = freedom > 1000000 ? 1000000 : freedom;
  double low = 0, high = 0x1.921fb54442d18p+0;
  for (int k = 0; k < 80; k++) {
    const double middle = 0.5 * (low + high);
    if (student_inside(middle, held) < inside)
      low = middle;
    else
      high = middle;
  }
  return sqrt((double)held) * pl_tan(low);
}
