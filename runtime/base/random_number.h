/* Random numbers that are functions of a key: the same whatever the order in which they are asked
   for. */
#ifndef PERILAT_RUNTIME_RANDOM_NUMBER_H
#define PERILAT_RUNTIME_RANDOM_NUMBER_H

#include <stdint.h>

/* Finalizer of SplitMix64 (Steele, Lea and Flood 2014): every bit of the input changes half of the
   output's. */
static inline uint64_t random_mix(uint64_t x) {
  x += UINT64_C(0x9e3779b97f4a7c15);
  x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
  x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
  return x ^ x >> 31;
}

/* In (0, 1), both ends left out. */
static inline double random_unit(uint64_t bits) {
  return ((double)(bits >> 12) + 0.5) * 0x1p-52;
}

#endif
