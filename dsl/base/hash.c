#include "dsl/base/hash.h"

#include <string.h>

uint64_t hash_more(uint64_t hash, const void *data, size_t bytes) {
  const unsigned char *at = data;
  for (size_t k = 0; k < bytes; k++)
    hash = (hash ^ at[k]) * UINT64_C(0x100000001b3);
  return hash;
}

static uint64_t round_of(uint64_t lane, uint64_t word) {
  lane += word * UINT64_C(0xc2b2ae3d27d4eb4f);
  return (lane << 31 | lane >> 33) * UINT64_C(0x9e3779b185ebca87);
}

uint64_t hash_words(uint64_t hash, const void *data, size_t words) {
  enum { LANES = 4 };
  const unsigned char *at = data;
  uint64_t lane[LANES] = {0, 1, 2, 3}, next[LANES];
  for (; words >= LANES; words -= LANES, at += sizeof next) {
    memcpy(next, at, sizeof next);
    for (int k = 0; k < LANES; k++)
      lane[k] = round_of(lane[k], next[k]);
  }
  for (int k = 0; k < LANES; k++)
    hash = round_of(hash, lane[k]);
  for (; words > 0; words--, at += sizeof *next) {
    memcpy(next, at, sizeof *next);
    hash = round_of(hash, *next);
  }
  return hash;
}
