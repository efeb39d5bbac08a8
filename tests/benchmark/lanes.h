/* Eight doubles that are computed together. With AVX-512 one register; elsewhere the compiler
 * splits them. */
#ifndef PERILAT_BENCHMARK_LANES_H
#define PERILAT_BENCHMARK_LANES_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#if defined(__AVX512F__) && defined(__AVX512DQ__)
#include <immintrin.h>
#define LANES_AVX512 1
#else
#define LANES_AVX512 0
#endif

#define LANES          8
#define LANES_FUNCTION static inline __attribute__((always_inline, unused))

typedef double lanes __attribute__((vector_size(LANES * sizeof(double))));
typedef double lanes_anywhere
    __attribute__((vector_size(LANES * sizeof(double)), aligned(sizeof(double)), may_alias));

LANES_FUNCTION lanes lanes_load(const double *p) {
  return *(const lanes_anywhere *)p;
}
LANES_FUNCTION void lanes_store(double *p, lanes x) {
  *(lanes_anywhere *)p = x;
}
LANES_FUNCTION lanes lanes_all(double x) {
  return (lanes){x, x, x, x, x, x, x, x};
}

/* The last lane of `before`, then all but the last of `x`. */
LANES_FUNCTION lanes lanes_shift_in(lanes before, lanes x) {
  return __builtin_shufflevector(before, x, 7, 8, 9, 10, 11, 12, 13, 14);
}

#if LANES_AVX512

LANES_FUNCTION lanes lanes_abs(lanes x) {
  return (lanes)_mm512_abs_pd((__m512d)x);
}
LANES_FUNCTION lanes lanes_max(lanes a, lanes b) {
  return (lanes)_mm512_max_pd((__m512d)a, (__m512d)b);
}
LANES_FUNCTION lanes lanes_min(lanes a, lanes b) {
  return (lanes)_mm512_min_pd((__m512d)a, (__m512d)b);
}

/* 1/sqrt(x) to an ulp or two, for normal x > 0, without the slow divider: the machine's 14 bits,
   and one step of fourth order, 1/sqrt(1 - e) = 1 + e/2 + 3 e^2/8 + 5 e^3/16 + ... */
LANES_FUNCTION lanes lanes_inverse_root(lanes x) {
  const lanes y = (lanes)_mm512_rsqrt14_pd((__m512d)x);
  const lanes e = 1 - (x * y) * y;
  return y + (y * e) * (0.5 + e * (0.375 + e * 0.3125));
}

/* A bit for each lane with |x| > limit, or x no number. */
LANES_FUNCTION unsigned lanes_beyond(lanes x, double limit) {
  return _mm512_cmp_pd_mask(_mm512_abs_pd((__m512d)x), _mm512_set1_pd(limit), _CMP_NLE_UQ);
}

/* A bit for each lane with x > limit, or x no number, and y > 0. */
LANES_FUNCTION unsigned lanes_above(lanes x, double limit, lanes y) {
  const __mmask8 above = _mm512_cmp_pd_mask((__m512d)x, _mm512_set1_pd(limit), _CMP_NLE_UQ);
  return _mm512_mask_cmp_pd_mask(above, (__m512d)y, _mm512_setzero_pd(), _CMP_GT_OQ);
}

#else

LANES_FUNCTION lanes lanes_abs(lanes x) {
  for (int l = 0; l < LANES; l++)
    x[l] = __builtin_fabs(x[l]);
  return x;
}
LANES_FUNCTION lanes lanes_max(lanes a, lanes b) {
  for (int l = 0; l < LANES; l++)
    a[l] = a[l] > b[l] ? a[l] : b[l];
  return a;
}
LANES_FUNCTION lanes lanes_min(lanes a, lanes b) {
  for (int l = 0; l < LANES; l++)
    a[l] = a[l] < b[l] ? a[l] : b[l];
  return a;
}
LANES_FUNCTION lanes lanes_inverse_root(lanes x) {
  for (int l = 0; l < LANES; l++)
    x[l] = __builtin_sqrt(x[l]);
  return 1 / x;
}
LANES_FUNCTION unsigned lanes_beyond(lanes x, double limit) {
  unsigned bits = 0;
  for (int l = 0; l < LANES; l++)
    bits |= (unsigned)!(__builtin_fabs(x[l]) <= limit) << l;
  return bits;
}
LANES_FUNCTION unsigned lanes_above(lanes x, double limit, lanes y) {
  unsigned bits = 0;
  for (int l = 0; l < LANES; l++)
    bits |= (unsigned)(!(x[l] <= limit) & (y[l] > 0)) << l;
  return bits;
}

#endif
#endif
