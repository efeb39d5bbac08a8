/* FNV-1a, 64 bits (Fowler, Noll, Vo): for tables, checksums, fingerprints; not for secrets. */
#ifndef PERILAT_DSL_HASH_H
#define PERILAT_DSL_HASH_H

#include <stddef.h>
#include <stdint.h>

#define HASH_START UINT64_C(0xcbf29ce484222325)

/* The hash of what had `hash` with `bytes` bytes more. */
uint64_t hash_more(uint64_t hash, const void *data, size_t bytes);
/* For long arrays of numbers, at the speed of memory: another hash, of words of 8 bytes, in four
   lanes that do not wait for each other (rounds as of Collet's XXH64). A change of one word always
   changes it. */
uint64_t hash_words(uint64_t hash, const void *data, size_t words);

#endif
