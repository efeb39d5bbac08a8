/* Numbers of a page in few characters: base64 (RFC 4648) of little-endian numbers, whole numbers of
   seven bits a byte, and bytes of which many are 0. The script of the page (page.js) reads them. */
#ifndef PERILAT_GENERATOR_PAGE_PACKING_H
#define PERILAT_GENERATOR_PAGE_PACKING_H

#include <stddef.h>
#include <stdint.h>

/* Bytes that grow; `bytes` may be NULL while there are none. */
typedef struct packing {
  unsigned char *bytes; /* [count] */
  size_t count, room;
} packing;

void packing_free(packing *p);
void packing_byte(packing *p, unsigned char byte);
/* 8 bytes each, to the last bit. */
void packing_doubles(packing *p, const double *values, long count);
/* 4 bytes: 24 bits of the number. */
void packing_floats(packing *p, const double *values, long count);
/* A part of a range as one of 65536 steps: 2 bytes; NaN is taken for `low`. */
void packing_steps(packing *p, const double *values, long count, double low, double high);
/* Small numbers in one byte, sign and all: 0, -1, 1, -2, ... */
void packing_whole(packing *p, long number);
/* What differs from `before` (NULL: from 0), as runs: how many bytes are the same, how many are
   not, and the differences of these. */
void packing_runs(packing *p, const unsigned char *now, const unsigned char *before, long count);
/* Value as one of 254 steps from 1 to 255; 0 for what is no number. */
unsigned char packing_step(double value, double low, double high);

/* malloc'ed. */
char *packing_base64(const void *bytes, size_t count);
char *packing_text(const packing *p);

#endif
