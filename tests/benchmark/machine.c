#include "tests/benchmark/machine.h"

#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "dsl/arena.h"
#include "tests/benchmark/lanes.h"

enum { ROUNDS = 8, CHAINS = 16, CACHED = 1024, FMA_STEPS = 1 << 20 };
#define FAR (1L << 24) /* doubles of an array: 128 MiB */

static double processor_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static __attribute__((noinline)) void triad(long count, double x, const double *restrict b,
                                            const double *restrict c, double *restrict a) {
  for (long k = 0; k < count; k++)
    a[k] = b[k] + x * c[k];
}

static double triad_rate(long count, long repeats) {
  double *a = must_alloc((size_t)count * sizeof *a), *b = must_alloc((size_t)count * sizeof *b),
         *c = must_alloc((size_t)count * sizeof *c), best = 0;
  for (long k = 0; k < count; k++) { /* so that the pages exist */
    a[k] = 0;
    b[k] = 1;
    c[k] = 2;
  }
  for (int round = 0; round < ROUNDS; round++) {
    const double begun = processor_seconds();
    for (long k = 0; k < repeats; k++)
      triad(count, 1e-9 * (double)k, b, c, a);
    best = fmax(best, 24.0 * (double)(count * repeats) / (processor_seconds() - begun));
  }
  free(a);
  free(b);
  free(c);
  return best;
}

/* Independent chains, so that no multiply-add waits for another. What they come to is stored, so that they are computed. */
static __attribute__((noinline)) void fma_chains(long steps, double factor, lanes *sums) {
  lanes s[CHAINS], x = lanes_all(factor);
  for (int k = 0; k < CHAINS; k++)
    s[k] = sums[k];
  for (long n = 0; n < steps; n++) {
#pragma GCC unroll 16
    for (int k = 0; k < CHAINS; k++)
#if LANES == 8
      s[k] = (lanes)_mm512_fmadd_pd((__m512d)s[k], (__m512d)x, (__m512d)x);
#elif defined(__FMA__)
      s[k] = (lanes)_mm256_fmadd_pd((__m256d)s[k], (__m256d)x, (__m256d)x);
#else
      s[k] = s[k] * x + x;
#endif
  }
  for (int k = 0; k < CHAINS; k++)
    sums[k] = s[k];
}

static double fma_rate(void) {
  static lanes sums[CHAINS];
  double best = 0;
  for (int round = 0; round < ROUNDS; round++) {
    const double begun = processor_seconds();
    fma_chains(FMA_STEPS, 0.5, sums);
    best = fmax(best, 2.0 * FMA_STEPS * CHAINS * LANES / (processor_seconds() - begun));
  }
  return best;
}

machine machine_measure(void) {
  return (machine){.cores = (int)sysconf(_SC_NPROCESSORS_ONLN),
                   .triad = triad_rate(FAR, 1),
                   .cached_triad = triad_rate(CACHED, 1 << 14),
                   .fma = fma_rate()};
}
