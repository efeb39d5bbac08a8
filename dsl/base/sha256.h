/* SHA-256 (FIPS 180-4): names of cached kernels, the seals on them and on results. */
#ifndef PERILAT_DSL_SHA256_H
#define PERILAT_DSL_SHA256_H

#include <stddef.h>
#include <stdint.h>

#define SHA256_SIZE 32
#define SHA256_TEXT (2 * SHA256_SIZE + 1)

typedef struct sha256 {
  uint32_t state[8];
  uint64_t length; /* bytes so far */
  unsigned char block[64];
} sha256;

void sha256_begin(sha256 *h);
void sha256_add(sha256 *h, const void *data, size_t size);
void sha256_end(sha256 *h, unsigned char digest[SHA256_SIZE]);
/* The end, as hexadecimal digits. */
void sha256_text(sha256 *h, char text[SHA256_TEXT]);

#endif
