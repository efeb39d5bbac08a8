/* The law as a specialist would program it for this one lattice: rows without a neighbour list,
   structure of arrays, eight bonds at once, bond forces that stay in registers and in two rows of
   buffers, one division a bond and the arc sine's series for the chord's rotation. What a compiler
   of laws should come near to.

   It exists twice, compiled without and with contraction to fused multiply-adds. */
#ifndef PERILAT_BENCHMARK_HANDWRITTEN_H
#define PERILAT_BENCHMARK_HANDWRITTEN_H

#include "tests/benchmark/problem.h"

typedef struct handwritten handwritten;

#define HANDWRITTEN_FUNCTIONS(prefix)                                                              \
  handwritten *prefix##_new(const problem *p);                                                     \
  void prefix##_free(handwritten *h);                                                              \
  void prefix##_set(handwritten *h, const motion *from);                                           \
  void prefix##_get(const handwritten *h, motion *to);                                             \
  void prefix##_advance(handwritten *h, long steps);                                               \
  /* Bonds, summed over the steps since the start, of rows with one too far for the series. */     \
  long prefix##_rare(const handwritten *h);

HANDWRITTEN_FUNCTIONS(handwritten)
HANDWRITTEN_FUNCTIONS(handwritten_fused)

#endif
