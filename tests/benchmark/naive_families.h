/* Laws of families, and of beams between neighbours, as a careful beginner would program them: a
   structure per particle, a list of neighbours with a structure each, a function per bond, the
   library's square root, a branch per case. The yardstick for the faster ones. */
#ifndef PERILAT_BENCHMARK_NAIVE_FAMILIES_H
#define PERILAT_BENCHMARK_NAIVE_FAMILIES_H

#include "tests/benchmark/family_problem.h"

extern const body_program naive_elastic, naive_concrete, naive_lps, naive_beams;

#endif
