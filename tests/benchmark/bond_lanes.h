/* Stretches of bonds and columns of rows for the hand-written loops of families. Lengths in
   spacings or in the bond's own length, velocities in spacings a step. */
#ifndef PERILAT_BENCHMARK_BOND_LANES_H
#define PERILAT_BENCHMARK_BOND_LANES_H

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/kernel.h"
#include "tests/benchmark/lanes.h"

#if defined(__clang__)
#define UNROLL
#else
#define UNROLL _Pragma("GCC unroll 2")
#endif

typedef struct bond_lanes {
  lanes inverse; /* reference length over length */
  lanes twice;   /* 2 stretch */
} bond_lanes;

/* From growth = (length/reference length)^2 - 1. With r = sqrt(1 + growth) - 1: 2 r = growth - r^2,
   which forgives the cancellation in the r on the right. */
LANES_FUNCTION bond_lanes bond_of_growth(lanes growth) {
  const lanes square = 1 + growth, inverse = lanes_inverse_root(square);
  const lanes rough = square * inverse - 1;
  return (bond_lanes){inverse, growth - rough * rough};
}

static inline double *lanes_zeros(long count) {
  const size_t bytes = (size_t)(count + 2 * LANES) * sizeof(double) / PL_ALIGNMENT * PL_ALIGNMENT;
  double *p = aligned_alloc(PL_ALIGNMENT, bytes + PL_ALIGNMENT);
  if (!p) must_alloc(SIZE_MAX); /* ends the program with the usual message */
  return memset(p, 0, bytes + PL_ALIGNMENT);
}

/* Arrays of `count` zeros each in one piece of memory, which the first owns. The same places of no
   two of a dozen are a multiple of 4 KiB apart: a load would wait for the store to such a place. */
enum { LANES_PAGE = 4096 / sizeof(double), LANES_STAGGER = 88 };

static inline void lanes_share(double **const *arrays, int how_many, long count) {
  const long apart = (count + 2 * LANES + LANES_PAGE) / LANES_PAGE * LANES_PAGE + LANES_STAGGER;
  double *next = lanes_zeros(how_many * apart);
  for (int k = 0; k < how_many; k++, next += apart)
    *arrays[k] = next;
}

#endif
