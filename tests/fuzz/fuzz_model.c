/* A law's text through the whole front end: read, checked, its ranges followed, driven through the
   physics checks, planned, emitted, laid out, explained. Besides sanitizers these watch: errors and
   results exclude each other, places lie in the text, the layout keeps the tree and is laid out,
   the emitted C holds nothing but what the emitter writes. */
#include "tests/fuzz/law_stages.h"

enum { LONGEST = 1 << 16 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size <= LONGEST) check_law((const char *)data, size, fuzz_choose(data, size));
  return 0;
}
