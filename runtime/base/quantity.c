#include "runtime/base/quantity.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/units.h"

enum { LONGEST = 100 };

bool quantity_begins(const char *text) {
  text += strspn(text, " +-.");
  return isdigit((unsigned char)*text);
}

const char *time_text(double time, int digits, char text[TIME_TEXT]) {
  const double hour = 3600, size = fabs(time);
  if (size >= hour)
    snprintf(text, TIME_TEXT, "%.*g h", digits, time / hour);
  else if (size >= 10)
    snprintf(text, TIME_TEXT, "%.*g s", digits, time);
  else
    snprintf(text, TIME_TEXT, "%.*g ms", digits, 1e3 * time);
  return text;
}

bool quantity_read(const char *text, size_t length, const char *si_unit, double *value) {
  char part[LONGEST + 1], *end;
  const char *bad;
  size_t bad_length;
  unit needed, given;
  if (length > LONGEST || !quantity_begins(text)) return false;
  snprintf(part, sizeof part, "%.*s", (int)length, text);
  *value = strtod(part, &end);
  for (size_t n = strlen(end); n > 0 && end[n - 1] == ' '; n--)
    end[n - 1] = 0;
  end += strspn(end, " ");
  if (!unit_parse(si_unit, strlen(si_unit), &needed, &bad, &bad_length)) return false;
  given = (unit){.dim = needed.dim, .factor = 1};
  if (*end && !unit_parse(end, strlen(end), &given, &bad, &bad_length)) return false;
  *value *= given.factor;
  return isfinite(*value) && dim_equal(given.dim, needed.dim);
}
