/* What the fuzzers share: the entry that libFuzzer and replay.c call, the choice of what is tried
   with an input, and a way to fail. */
#ifndef PERILAT_TESTS_FUZZ_H
#define PERILAT_TESTS_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What must hold for every input, whatever it is. */
#define MUST(condition)                                                                            \
  do {                                                                                             \
    if (!(condition)) {                                                                            \
      fprintf(stderr, "%s:%d: does not hold: %s\n", __FILE__, __LINE__, #condition);               \
      abort();                                                                                     \
    }                                                                                              \
  } while (0)

/* Slow parts are tried with a share of the inputs only, chosen by the input's bytes: an input that
   fails fails again. With FUZZ_EVERYTHING in the environment (replay.c sets it) every input goes
   through every part. */
typedef uint64_t fuzz_choice;

static inline fuzz_choice fuzz_choose(const uint8_t *data, size_t size) {
  static int everything = -1;
  if (everything < 0) everything = getenv("FUZZ_EVERYTHING") != NULL;
  if (everything) return 0;
  fuzz_choice hash = UINT64_C(0xcbf29ce484222325); /* FNV-1a */
  for (size_t k = 0; k < size; k++)
    hash = (hash ^ data[k]) * UINT64_C(0x100000001b3);
  return hash;
}

/* Is the part tried that one input in so many goes through? Parts of different numbers are chosen
   apart from each other when the numbers have no common factor. */
static inline bool fuzz_one_in(fuzz_choice choice, unsigned many) {
  return (choice >> 8) % many == 0;
}

/* Where messages go: written, so that their printing is tried too, and not seen. */
static inline FILE *nowhere(void) {
  static FILE *out;
  if (!out) out = fopen("/dev/null", "w");
  MUST(out);
  return out;
}

#endif
