#include "generator/page/packing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

void packing_free(packing *p) {
  free(p->bytes);
  *p = (packing){.bytes = NULL};
}

void packing_byte(packing *p, unsigned char byte) {
  if (p->count == p->room) {
    p->room = p->room ? 2 * p->room : 256;
    unsigned char *larger = must_alloc(p->room);
    if (p->count) memcpy(larger, p->bytes, p->count);
    free(p->bytes);
    p->bytes = larger;
  }
  p->bytes[p->count++] = byte;
}

static void put_bits(packing *p, uint64_t bits, int bytes) {
  for (int k = 0; k < bytes; k++)
    packing_byte(p, (unsigned char)(bits >> 8 * k));
}

void packing_doubles(packing *p, const double *values, long count) {
  for (long k = 0; k < count; k++) {
    uint64_t bits;
    memcpy(&bits, &values[k], sizeof bits);
    put_bits(p, bits, 8);
  }
}

void packing_floats(packing *p, const double *values, long count) {
  for (long k = 0; k < count; k++) {
    const float value = (float)values[k];
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_bits(p, bits, 4);
  }
}

void packing_steps(packing *p, const double *values, long count, double low, double high) {
  const double range = high > low ? high - low : 1;
  for (long k = 0; k < count; k++) {
    const double part = isnan(values[k]) ? 0 : (values[k] - low) / range;
    put_bits(p, (uint64_t)lround(65535 * pl_fmin(pl_fmax(part, 0), 1)), 2);
  }
}

void packing_whole(packing *p, long number) {
  uint64_t rest = number < 0 ? 2 * (uint64_t) - (number + 1) + 1 : 2 * (uint64_t)number;
  for (; rest >= 128; rest >>= 7)
    packing_byte(p, (unsigned char)(rest | 128));
  packing_byte(p, (unsigned char)rest);
}

static unsigned char change(const unsigned char *now, const unsigned char *before, long k) {
  return (unsigned char)(now[k] - (before ? before[k] : 0));
}

/* Two bytes that stay the same do not end a run of changes. */
void packing_runs(packing *p, const unsigned char *now, const unsigned char *before, long count) {
  for (long at = 0; at < count;) {
    long same = at;
    while (same < count && change(now, before, same) == 0)
      same++;
    long end = same, quiet = 0;
    for (; end < count && quiet < 3; end++)
      quiet = change(now, before, end) == 0 ? quiet + 1 : 0;
    end -= quiet;
    packing_whole(p, same - at);
    packing_whole(p, end - same);
    for (long k = same; k < end; k++)
      packing_byte(p, change(now, before, k));
    at = end;
  }
}

unsigned char packing_step(double value, double low, double high) {
  if (isnan(value)) return 0;
  const double part = high > low ? (value - low) / (high - low) : 0;
  return (unsigned char)(1 + lround(254 * pl_fmin(pl_fmax(part, 0), 1)));
}

char *packing_base64(const void *bytes, size_t count) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const unsigned char *from = bytes;
  char *text = must_alloc(4 * ((count + 2) / 3) + 1), *to = text;
  for (size_t k = 0; k < count; k += 3) {
    const size_t left = count - k;
    const uint32_t group = (uint32_t)from[k] << 16 | (left > 1 ? (uint32_t)from[k + 1] << 8 : 0) |
                           (left > 2 ? from[k + 2] : 0);
    *to++ = digits[group >> 18];
    *to++ = digits[group >> 12 & 63];
    *to++ = '=';
    *to++ = '=';
    if (left > 1) to[-2] = digits[group >> 6 & 63];
    if (left > 2) to[-1] = digits[group & 63];
  }
  *to = 0;
  return text;
}

char *packing_text(const packing *p) {
  return packing_base64(p->bytes, p->count);
}
