#include "dsl/base/sha256.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* First 32 bits of the fractional parts of the cube roots of the first 64 primes (section 4.2.2).
 */
static const uint32_t round_constants[64] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

static uint32_t turn(uint32_t x, int bits) {
  return (x >> bits) | (x << (32 - bits));
}

static void expand(const unsigned char block[64], uint32_t w[64]) {
  for (int t = 0; t < 16; t++)
    w[t] = (uint32_t)block[4 * t] << 24 | (uint32_t)block[4 * t + 1] << 16 |
           (uint32_t)block[4 * t + 2] << 8 | block[4 * t + 3];
  for (int t = 16; t < 64; t++) {
    uint32_t a = w[t - 15], b = w[t - 2];
    w[t] = w[t - 16] + w[t - 7] + (turn(a, 7) ^ turn(a, 18) ^ (a >> 3)) +
           (turn(b, 17) ^ turn(b, 19) ^ (b >> 10));
  }
}

static void digest_block(uint32_t state[8], const unsigned char block[64]) {
  uint32_t w[64], a = state[0], b = state[1], c = state[2], d = state[3], e = state[4],
                  f = state[5], g = state[6], h = state[7];
  expand(block, w);
  for (int t = 0; t < 64; t++) {
    const uint32_t choice = (e & f) ^ (~e & g), majority = (a & b) ^ (a & c) ^ (b & c);
    const uint32_t first =
        h + (turn(e, 6) ^ turn(e, 11) ^ turn(e, 25)) + choice + round_constants[t] + w[t];
    const uint32_t second = (turn(a, 2) ^ turn(a, 13) ^ turn(a, 22)) + majority;
    h = g, g = f, f = e, e = d + first;
    d = c, c = b, b = a, a = first + second;
  }
  const uint32_t more[8] = {a, b, c, d, e, f, g, h};
  for (int k = 0; k < 8; k++)
    state[k] += more[k];
}

void sha256_begin(sha256 *h) {
  static const uint32_t start[8] = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                    0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  memcpy(h->state, start, sizeof start);
  h->length = 0;
}

void sha256_add(sha256 *h, const void *data, size_t size) {
  const unsigned char *bytes = data;
  while (size > 0) {
    const size_t at = h->length % 64, part = size < 64 - at ? size : 64 - at;
    const bool whole = part == 64; /* digested where it stands */
    if (!whole) memcpy(h->block + at, bytes, part);
    if (at + part == 64) digest_block(h->state, whole ? bytes : h->block);
    h->length += part;
    bytes += part;
    size -= part;
  }
}

void sha256_end(sha256 *h, unsigned char digest[SHA256_SIZE]) {
  uint64_t bits = 8 * h->length;
  sha256_add(h, "\x80", 1);
  while (h->length % 64 != 56)
    sha256_add(h, "", 1);
  for (int shift = 56; shift >= 0; shift -= 8)
    sha256_add(h, &(unsigned char){(unsigned char)(bits >> shift)}, 1);
  for (int k = 0; k < SHA256_SIZE; k++)
    digest[k] = (unsigned char)(h->state[k / 4] >> (24 - 8 * (k % 4)));
}

void sha256_text(sha256 *h, char text[SHA256_TEXT]) {
  unsigned char digest[SHA256_SIZE];
  sha256_end(h, digest);
  for (int k = 0; k < SHA256_SIZE; k++)
    snprintf(text + 2 * k, 3, "%02x", digest[k]);
}
