/* The law as a careful beginner would program it: a structure per particle, a structure per bond, a
   function per bond, the library's square root and arc tangent, a branch per case. The yardstick
   for the faster ones. */
#ifndef PERILAT_BENCHMARK_NAIVE_H
#define PERILAT_BENCHMARK_NAIVE_H

#include "tests/benchmark/problem.h"

typedef struct naive naive;

naive *naive_new(const problem *p);
void naive_free(naive *n);
void naive_set(naive *n, const motion *from);
void naive_get(const naive *n, motion *to);
void naive_advance(naive *n, long steps);

#endif
