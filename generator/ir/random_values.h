/* Random numbers for checks: the same seed gives the same numbers everywhere (splitmix64; Steele,
 * Lea and Flood 2014). */
#ifndef PERILAT_GENERATOR_RANDOM_VALUES_H
#define PERILAT_GENERATOR_RANDOM_VALUES_H

#include <stdint.h>

#include "runtime/kernel.h"

uint64_t draw_bits(uint64_t *seed);
/* In [low, high). */
double draw_uniform(uint64_t *seed, double low, double high);
/* Log-uniform in size between 10^low and 10^high, of either sign; exactly 0 once in sixteen. */
double draw_size(uint64_t *seed, double low, double high);
/* A value that a bond may carry: damage 0, 1 or between, other fields near their initial value. */
double draw_field(uint64_t *seed, const pl_field *field);

#endif
