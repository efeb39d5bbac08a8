#include "dsl/syntax/parsing.h"

#include <string.h>

bool first_complaint(parsing *p) {
  bool first = !p->failed;
  p->failed = true;
  return first;
}

bool text_acceptable(const source_set *sources, int file, diagnostics *d) {
  const source *s = &sources->items[file];
  span start = {0, 0, (uint16_t)file};
  if (s->length > TEXT_LONGEST) {
    diag_report(d, DIAG_TOO_LONG, start, "the text has %zu bytes; a model may have up to %d",
                s->length, TEXT_LONGEST);
    return false;
  }
  const char *nul = memchr(s->text, 0, s->length);
  if (!nul) return true;
  uint32_t at = (uint32_t)(nul - s->text);
  diag_report(d, DIAG_BAD_CHARACTER, (span){at, at, (uint16_t)file},
              "there is a NUL byte here; this is not a text file");
  return false;
}
