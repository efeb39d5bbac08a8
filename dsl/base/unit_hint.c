#include "dsl/base/unit_hint.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "dsl/base/units.h"

enum { LONGEST = 40 };

static bool is_unit(const char *text, size_t length, unit *u) {
  const char *bad;
  size_t bad_length;
  return length > 0 && unit_parse(text, length, u, &bad, &bad_length);
}

static bool has_mass(const unit *u) {
  return u->dim.twelfths[1] != 0;
}

/* Letters of `m` in m2; 0 when it is no such power. */
static size_t power_begins_at(const char *text, size_t length) {
  unit base;
  size_t letters = length;
  while (letters > 0 && isdigit((unsigned char)text[letters - 1]))
    letters--;
  return letters < length && is_unit(text, letters, &base) ? letters : 0;
}

/* Letters of `N` in Nm, a unit with mass in it before one without; 0 when it is no such product. */
static size_t product_splits_at(const char *text, size_t length) {
  unit first, second;
  for (size_t k = length - 1; k > 0; k--)
    if (is_unit(text, k, &first) && is_unit(text + k, length - k, &second) && has_mass(&first) &&
        !has_mass(&second) && !dim_is_none(second.dim))
      return k;
  return 0;
}

/* sqrt m, the root sign, or the end of m^1/2. */
static bool is_root(const char *text, size_t length) {
  static const char word[] = "sqrt", sign[] = "\xe2\x88\x9a";
  bool digits = true;
  for (size_t k = 0; k < length; k++) {
    digits = digits && isdigit((unsigned char)text[k]);
    if (length - k >= sizeof sign - 1 && memcmp(text + k, sign, sizeof sign - 1) == 0) return true;
  }
  return digits || (length >= sizeof word - 1 && memcmp(text, word, sizeof word - 1) == 0);
}

/* What is no unit here, and what to write. */
static const struct {
  const char *words, *hint;
} others[] = {
    {"d day days", "a day is 24 h: give the time in `h`"},
    {"a y yr year years", "a year is 8766 h: give the time in `h`"},
    {"hr hrs hour hours", "write `h`"},
    {"sec secs second seconds", "write `s`"},
    {"minute minutes", "write `min`"},
    {"C degC \xC2\xB0"
     "C celsius Celsius",
     "temperatures are in `K`: 20 degrees Celsius are 293.15 K, and a difference of 1 degree is 1 "
     "K"},
    {"kelvin Kelvin degK", "write `K`"},
};

static const char *hint_of_other(const char *text, size_t length) {
  for (size_t k = 0; k < sizeof others / sizeof *others; k++)
    for (const char *at = others[k].words; *at;) {
      const size_t size = strcspn(at, " ");
      if (size == length && memcmp(at, text, length) == 0) return others[k].hint;
      at += size + (at[size] == ' ');
    }
  return NULL;
}

bool unit_hint(diagnostics *d, const char *text, size_t length) {
  if (length == 0 || length > LONGEST) return false;
  const char *other = hint_of_other(text, length);
  if (other) {
    diag_hint(d, "%s", other);
    return true;
  }
  if (is_root(text, length)) {
    diag_hint(d,
              "a root of a unit is written `sqrt(m)`, or as an exponent in parentheses: `m^(1/2)`");
    return true;
  }
  size_t power = power_begins_at(text, length), product = product_splits_at(text, length);
  size_t first = power ? power : product;
  if (first) {
    diag_hint(d, "write `%.*s%c%.*s`", (int)first, text, power ? '^' : '*', (int)(length - first),
              text + first);
    return true;
  }
  char name[LONGEST + 1];
  int count;
  const char *const *symbols = unit_symbols(&count);
  snprintf(name, sizeof name, "%.*s", (int)length, text);
  const char *nearest = nearest_name(name, symbols, count);
  if (nearest) diag_hint(d, "did you mean `%s`?", nearest);
  return nearest;
}
