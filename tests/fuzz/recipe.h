/* An input as the numbers that something is made from. */
#ifndef PERILAT_TESTS_RECIPE_H
#define PERILAT_TESTS_RECIPE_H

#include "tests/fuzz/fuzz.h"

/* Reads an input piece by piece; behind its end there are zeros. */
typedef struct recipe {
  const uint8_t *at, *end;
} recipe;

static inline unsigned recipe_byte(recipe *r) {
  return r->at < r->end ? *r->at++ : 0;
}

static inline uint64_t recipe_number(recipe *r, int bytes) {
  uint64_t n = 0;
  for (int k = 0; k < bytes; k++)
    n |= (uint64_t)recipe_byte(r) << 8 * k;
  return n;
}

#endif
