/* The doubles of one register, computed together: eight with AVX-512, four with AVX, else two. */
#ifndef PERILAT_BENCHMARK_LANES_H
#define PERILAT_BENCHMARK_LANES_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#if defined(__AVX__)
#include <immintrin.h>
#endif

#if defined(__AVX512F__) && defined(__AVX512DQ__)
#define LANES         8
#define LANES_SHIFTED 7, 8, 9, 10, 11, 12, 13, 14
#elif defined(__AVX__)
#define LANES         4
#define LANES_SHIFTED 3, 4, 5, 6
#else
#define LANES         2
#define LANES_SHIFTED 1, 2
#endif

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
  return x - (lanes){0};
}

/* The last lane of `before`, then all but the last of `x`. */
LANES_FUNCTION lanes lanes_shift_in(lanes before, lanes x) {
  return __builtin_shufflevector(before, x, LANES_SHIFTED);
}

/* lanes_max, lanes_min: the second where one is no number. lanes_inverse_root(x): 1/sqrt(x) to an
   ulp or two, for normal x > 0. lanes_beyond(x, limit), lanes_above(x, limit, y): marks lanes where
   |x| > limit, or x > limit and y > 0, or x is no number. Marks are gathered with |.
   lanes_marked(word, bit): marks lanes whose word has that bit. lanes_least(a, b): a >= b, false
   for no numbers. lanes_keep(m, x): x where marked, else 0. lanes_choose(m, a, b): a where marked,
   else b. lanes_inverse(x): 1/x to an ulp or two, for normal x > 0. */
#if LANES == 8

typedef __mmask8 lanes_marks;

LANES_FUNCTION bool lanes_any(lanes_marks m) {
  return m != 0;
}
LANES_FUNCTION lanes lanes_abs(lanes x) {
  return (lanes)_mm512_abs_pd((__m512d)x);
}
LANES_FUNCTION lanes lanes_max(lanes a, lanes b) {
  return (lanes)_mm512_max_pd((__m512d)a, (__m512d)b);
}
LANES_FUNCTION lanes lanes_min(lanes a, lanes b) {
  return (lanes)_mm512_min_pd((__m512d)a, (__m512d)b);
}

/* Spares the slow divider: the machine's 14 bits, and one step of fourth order,
   1/sqrt(1 - e) = 1 + e/2 + 3 e^2/8 + 5 e^3/16 + ... */
LANES_FUNCTION lanes lanes_inverse_root(lanes x) {
  const lanes y = (lanes)_mm512_rsqrt14_pd((__m512d)x);
  const lanes e = 1 - (x * y) * y;
  return y + (y * e) * (0.5 + e * (0.375 + e * 0.3125));
}

/* The same for 1/(1 - e) = (1 + e)(1 + e^2)(1 + e^4)...: 2^-56 after two factors. */
LANES_FUNCTION lanes lanes_inverse(lanes x) {
  const lanes y = (lanes)_mm512_rcp14_pd((__m512d)x);
  const lanes e = 1 - x * y, once = y + y * e;
  return once + once * (e * e);
}

LANES_FUNCTION lanes_marks lanes_marked(const uint64_t *words, uint64_t bit) {
  return _mm512_test_epi64_mask(_mm512_loadu_si512(words), _mm512_set1_epi64((int64_t)bit));
}
LANES_FUNCTION lanes_marks lanes_least(lanes a, lanes b) {
  return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_GE_OQ);
}
LANES_FUNCTION lanes lanes_keep(lanes_marks m, lanes x) {
  return (lanes)_mm512_maskz_mov_pd(m, (__m512d)x);
}
LANES_FUNCTION lanes lanes_choose(lanes_marks m, lanes a, lanes b) {
  return (lanes)_mm512_mask_blend_pd(m, (__m512d)b, (__m512d)a);
}

LANES_FUNCTION lanes_marks lanes_beyond(lanes x, double limit) {
  return _mm512_cmp_pd_mask(_mm512_abs_pd((__m512d)x), _mm512_set1_pd(limit), _CMP_NLE_UQ);
}

LANES_FUNCTION lanes_marks lanes_above(lanes x, double limit, lanes y) {
  const __mmask8 above = _mm512_cmp_pd_mask((__m512d)x, _mm512_set1_pd(limit), _CMP_NLE_UQ);
  return _mm512_mask_cmp_pd_mask(above, (__m512d)y, _mm512_setzero_pd(), _CMP_GT_OQ);
}

#else

typedef int64_t lanes_marks __attribute__((vector_size(LANES * sizeof(double))));

LANES_FUNCTION bool lanes_any(lanes_marks m) {
  int64_t any = 0;
  for (int l = 0; l < LANES; l++)
    any |= m[l];
  return any != 0;
}

LANES_FUNCTION lanes lanes_choose(lanes_marks m, lanes a, lanes b) {
  return (lanes)((m & (lanes_marks)a) | (~m & (lanes_marks)b));
}
LANES_FUNCTION lanes lanes_abs(lanes x) {
  return (lanes)((lanes_marks)x & INT64_MAX);
}
LANES_FUNCTION lanes lanes_max(lanes a, lanes b) {
  return lanes_choose(a > b, a, b);
}
LANES_FUNCTION lanes lanes_min(lanes a, lanes b) {
  return lanes_choose(a < b, a, b);
}

LANES_FUNCTION lanes lanes_inverse_root(lanes x) {
#if LANES == 4
  return 1 / (lanes)_mm256_sqrt_pd((__m256d)x);
#else
  for (int l = 0; l < LANES; l++)
    x[l] = __builtin_sqrt(x[l]);
  return 1 / x;
#endif
}

LANES_FUNCTION lanes lanes_inverse(lanes x) {
  return 1 / x;
}
LANES_FUNCTION lanes_marks lanes_marked(const uint64_t *words, uint64_t bit) {
  lanes_marks m;
  for (int l = 0; l < LANES; l++)
    m[l] = words[l] & bit ? -1 : 0;
  return m;
}
LANES_FUNCTION lanes_marks lanes_least(lanes a, lanes b) {
  return a >= b;
}
LANES_FUNCTION lanes lanes_keep(lanes_marks m, lanes x) {
  return (lanes)(m & (lanes_marks)x);
}
LANES_FUNCTION lanes_marks lanes_beyond(lanes x, double limit) {
  return ~(lanes_abs(x) <= limit);
}
LANES_FUNCTION lanes_marks lanes_above(lanes x, double limit, lanes y) {
  return ~(x <= limit) & (y > 0);
}

#endif
#endif
