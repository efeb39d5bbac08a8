/* SHA-256 (FIPS 180-4): names of cached kernels and the seal on them. */
#ifndef PERILAT_GENERATOR_SHA256_H
#define PERILAT_GENERATOR_SHA256_H

#include <stddef.h>
#include <stdint.h>

#define SHA256_SIZE 32

typedef struct sha256 {
  uint32_t state[8];
  uint64_t length; /* bytes so far */
  unsigned char block[64];
} sha256;

void sha256_begin(sha256 *h);
void sha256_add(sha256 *h, const void *data, size_t size);
void sha256_end(sha256 *h, unsigned char digest[SHA256_SIZE]);

#endif
