/* a*b + c rounded once, made of operations that round each: where the processor has no such
   operation this takes less time than C's library. */
#ifndef PERILAT_PLAYGROUND_FUSED_H
#define PERILAT_PLAYGROUND_FUSED_H

#include "dsl/base/elementary.h"

typedef struct fused_sum {
  double value, rest; /* value + rest is exact */
} fused_sum;

/* Knuth (1969) */
PL_ELEMENTARY fused_sum fused_add(double a, double b) {
  const double s = a + b, of_b = s - a, of_a = s - of_b;
  return (fused_sum){s, (a - of_a) + (b - of_b)};
}

/* The upper half of the bits (Veltkamp 1968). */
PL_ELEMENTARY double fused_upper(double a) {
  const double spread = 0x1.0000002p27 * a;
  return spread - (spread - a);
}

/* What a*b has lost in `product` (Dekker 1971). */
PL_ELEMENTARY double fused_rest(double a, double b, double product) {
  const double a_up = fused_upper(a), b_up = fused_upper(b), a_low = a - a_up, b_low = b - b_up;
  return ((a_up * b_up - product) + a_up * b_low + a_low * b_up) + a_low * b_low;
}

/* The sum; where it is between two numbers, the one whose last bit is 1. */
PL_ELEMENTARY double fused_to_odd(double a, double b) {
  const fused_sum s = fused_add(a, b);
  const uint64_t bits = pl_to_bits(s.value);
  const uint64_t odd = (s.rest > 0) == (s.value > 0) ? bits + 1 : bits - 1;
  return s.rest == 0 || (bits & 1) ? s.value : pl_from_bits(odd);
}

/* Nothing overflows, and nothing of the product is lost below the smallest numbers. */
PL_ELEMENTARY int fused_is_safe(double a, double b, double c) {
  return (pl_abs(a) <= 0x1p400) & (pl_abs(b) <= 0x1p400) & (pl_abs(c) <= 0x1p900) &
         (pl_abs(a * b) >= 0x1p-800);
}

/* Where that is so (Boldo and Melquiond 2008). */
PL_ELEMENTARY double fused_safe(double a, double b, double c) {
  const double product = a * b;
  const fused_sum low = fused_add(c, fused_rest(a, b, product)),
                  high = fused_add(product, low.value);
  return high.value + fused_to_odd(high.rest, low.rest);
}

#endif
