/* What the fuzzers share: the entry that libFuzzer and replay.c call, a place for files that no
   disk sees, and a way to fail. */
#ifndef PERILAT_TESTS_FUZZ_H
#define PERILAT_TESTS_FUZZ_H

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

/* Where messages go: written, so that their printing is tried too, and not seen. */
static inline FILE *nowhere(void) {
  static FILE *out;
  if (!out) out = fopen("/dev/null", "w");
  MUST(out);
  return out;
}

#endif
