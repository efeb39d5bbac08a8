#include "dsl/semantics/literals.h"

#include <string.h>

#include "dsl/base/unit_hint.h"

bool read_unit(checker *ck, const char *text, span where, unit *result) {
  const char *bad;
  size_t length, whole = strlen(text);
  if (unit_parse(text, whole, result, &bad, &length)) return true;
  span part = where;
  if (where.end - where.begin == whole && length > 0) {
    part.begin = where.begin + (uint32_t)(bad - text);
    part.end = part.begin + (uint32_t)length;
  }
  if (length == 0) {
    complain(ck, DIAG_UNKNOWN_UNIT, where, "a unit is missing in `[%s]`", text);
    diag_hint(ck->d, "write a unit such as `[N/m]`, or no brackets for a pure number");
  } else if (unit_is_whole(bad, length) && bad > text && memchr(text, '/', (size_t)(bad - text))) {
    complain(ck, DIAG_UNKNOWN_UNIT, part, "does `%.*s` stand above or below the line?", (int)length,
             bad);
    diag_hint(ck->d, "write `*`, or put the divisor in parentheses: `J/(kg*K)`");
  } else {
    complain(ck, DIAG_UNKNOWN_UNIT, part, "there is no unit `%.*s`", (int)length, bad);
    unit_hint(ck->d, bad, length);
  }
  return false;
}
