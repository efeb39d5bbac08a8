#include "dsl/base/powers.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"

enum { MOST_FACTORS = 64 };

/* The rounding errors of the products are carried along (Dekker 1971). */
static double whole_power(double x, int n) {
  double power = 1, rest = 0;
  for (int k = abs(n); k > 0; k--) {
    const double product = power * x;
    rest = rest * x + pl_fma(power, x, -product);
    power = product;
  }
  const bool lost = !isfinite(power) || fabs(power) < 0x1p-960; /* errors are no doubles any more */
  if (n >= 0) return lost ? power : power + rest;
  const double inverse = 1 / power;
  return lost || !isnormal(inverse)
             ? inverse
             : inverse + inverse * (pl_fma(-inverse, power, 1) - inverse * rest);
}

double power_of(double x, double y) {
  return fabs(y) <= MOST_FACTORS && y == floor(y) ? whole_power(x, (int)y) : pl_pow(x, y);
}

/* 18 digits tell all doubles from a power of ten but the one that stands for it, which may be a
   little below. */
int decade_of(double x) {
  char digits[40];
  snprintf(digits, sizeof digits, "%.17e", x);
  const int below = atoi(strchr(digits, 'e') + 1);
  snprintf(digits, sizeof digits, "1e%d", below + 1);
  return strtod(digits, NULL) <= x ? below + 1 : below;
}
