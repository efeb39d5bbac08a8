/* What one core of this machine can do at most, measured by the program itself: the scale for figures of kernels. */
#ifndef PERILAT_BENCHMARK_MACHINE_H
#define PERILAT_BENCHMARK_MACHINE_H

typedef struct machine {
  int cores; /* online */
  double
      triad; /* B/s of a[k] = b[k] + x c[k] on arrays beyond all caches, 24 bytes an element (McCalpin 1995) */
  double cached_triad; /* B/s of the same on arrays of 8 KiB, in the first cache */
  double fma;          /* flop/s of fused multiply-adds on registers, two flops each */
} machine;

/* The best of some rounds of each, in processor time; about a second in all. */
machine machine_measure(void);

#endif
