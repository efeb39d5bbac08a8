#include "dsl/hash.h"

uint64_t hash_more(uint64_t hash, const void *data, size_t bytes) {
  const unsigned char *at = data;
  for (size_t k = 0; k < bytes; k++)
    hash = (hash ^ at[k]) * UINT64_C(0x100000001b3);
  return hash;
}
