#include "dsl/base/units.h"

#include <assert.h>
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/powers.h"

const dimension DIMENSIONLESS = {{0, 0, 0, 0}};

/* No quantity of mechanics comes near this exponent; beyond it a dimension counts as overflown. */
enum { BASE_COUNT = 4, LARGEST_TWELFTHS = 12 * 100, DEEPEST_PARENTHESIS = 20 };

/* X(symbol, value in SI, exponents of m, kg, s, K) */
#define UNIT_SYMBOLS(X)                                                                            \
  X("m", 1, 1, 0, 0, 0)                                                                            \
  X("km", 1e3, 1, 0, 0, 0)                                                                         \
  X("dm", 1e-1, 1, 0, 0, 0)                                                                        \
  X("cm", 1e-2, 1, 0, 0, 0)                                                                        \
  X("mm", 1e-3, 1, 0, 0, 0)                                                                        \
  X("um", 1e-6, 1, 0, 0, 0) X("\xC2\xB5m", 1e-6, 1, 0, 0, 0) X("\xCE\xBCm", 1e-6, 1, 0, 0, 0) X(   \
      "nm", 1e-9, 1, 0, 0, 0) X("in", 0.0254, 1, 0, 0, 0) X("ft", 0.3048, 1, 0, 0, 0)              \
      X("kg", 1, 0, 1, 0, 0) X("g", 1e-3, 0, 1, 0, 0) X("mg", 1e-6, 0, 1, 0, 0) X(                 \
          "t", 1e3, 0, 1, 0, 0) X("lb", 0.45359237, 0, 1, 0, 0) X("s", 1, 0, 0, 1, 0)              \
          X("ms", 1e-3, 0, 0, 1, 0) X("us", 1e-6, 0, 0, 1, 0) X("\xC2\xB5s", 1e-6, 0, 0, 1, 0)     \
              X("\xCE\xBCs", 1e-6, 0, 0, 1, 0) X("ns", 1e-9, 0, 0, 1, 0) X("min", 60, 0, 0, 1, 0)  \
                  X("h", 3600, 0, 0, 1, 0) X("K", 1, 0, 0, 0, 1) X("N", 1, 1, 1, -2, 0)            \
                      X("mN", 1e-3, 1, 1, -2, 0) X("kN", 1e3, 1, 1, -2, 0)                         \
                          X("MN", 1e6, 1, 1, -2, 0) X("GN", 1e9, 1, 1, -2, 0)                      \
                              X("lbf", 4.4482216152605, 1, 1, -2, 0)                               \
                              X("Pa", 1, -1, 1, -2, 0) X("kPa", 1e3, -1, 1, -2, 0)                 \
                                  X("MPa", 1e6, -1, 1, -2, 0) X("GPa", 1e9, -1, 1, -2, 0)          \
                                      X("bar", 1e5, -1, 1, -2,                                     \
                                        0) X("psi", 6894.757293168361, -1, 1, -2,                  \
                                             0) X("ksi", 6894757.293168361, -1, 1, -2, 0)          \
                                          X("J", 1, 2, 1, -2, 0) X("mJ", 1e-3, 2, 1, -2, 0)        \
                                              X("kJ", 1e3, 2, 1, -2, 0) X("MJ", 1e6, 2, 1, -2, 0)  \
                                                  X("W", 1, 2, 1, -3, 0) X("kW", 1e3, 2, 1, -3, 0) \
                                                      X("Hz", 1, 0, 0, -1, 0) X("kHz", 1e3, 0, 0,  \
                                                                                -1, 0)             \
                                                          X("MHz", 1e6, 0, 0, -1, 0)               \
                                                              X("rad", 1, 0, 0, 0, 0)              \
                                                                  X("deg", 0.017453292519943295,   \
                                                                    0, 0, 0, 0)                    \
                                                                      X("1", 1, 0, 0, 0, 0)        \
                                                                          X("%", 0.01, 0, 0, 0, 0)

/* X(words with their article, unit, exponents of m, kg, s, K) */
#define DIMENSION_WORDS(X)                                                                         \
  X("a pure number", "1", 0, 0, 0, 0)                                                              \
  X("a length", "m", 1, 0, 0, 0)                                                                   \
  X("an area", "m^2", 2, 0, 0, 0)                                                                  \
  X("a volume", "m^3", 3, 0, 0, 0)                                                                 \
  X("a second moment of area", "m^4", 4, 0, 0, 0)                                                  \
  X("a curvature", "1/m", -1, 0, 0, 0)                                                             \
  X("a mass", "kg", 0, 1, 0, 0)                                                                    \
  X("a mass per length", "kg/m", -1, 1, 0, 0)                                                      \
  X("a mass per area", "kg/m^2", -2, 1, 0, 0)                                                      \
  X("a density", "kg/m^3", -3, 1, 0, 0)                                                            \
  X("a moment of inertia", "kg*m^2", 2, 1, 0, 0)                                                   \
  X("a time", "s", 0, 0, 1, 0)                                                                     \
  X("a rate", "1/s", 0, 0, -1, 0)                                                                  \
  X("a velocity", "m/s", 1, 0, -1, 0)                                                              \
  X("an acceleration", "m/s^2", 1, 0, -2, 0)                                                       \
  X("a momentum", "N*s", 1, 1, -1, 0)                                                              \
  X("a force", "N", 1, 1, -2, 0)                                                                   \
  X("a force rate", "N/s", 1, 1, -3, 0)                                                            \
  X("an energy or moment", "N*m", 2, 1, -2, 0)                                                     \
  X("a power", "W", 2, 1, -3, 0)                                                                   \
  X("a bending rigidity", "N*m^2", 3, 1, -2, 0)                                                    \
  X("a stiffness, load per length or fracture energy", "N/m", 0, 1, -2, 0)                                          \
  X("a damping coefficient", "N*s/m", 0, 1, -1, 0)                                                 \
  X("a stress", "Pa", -1, 1, -2, 0)                                                                \
  X("a stress rate", "Pa/s", -1, 1, -3, 0)                                                         \
  X("a viscosity", "Pa*s", -1, 1, -1, 0)                                                           \
  X("a compliance", "1/Pa", 1, -1, 2, 0)                                                           \
  X("a force per volume", "N/m^3", -2, 1, -2, 0)                                                   \
  X("a force per volume squared", "N/m^6", -5, 1, -2, 0)                                           \
  X("a specific energy", "J/kg", 2, 0, -2, 0)                                                      \
  X("a temperature", "K", 0, 0, 0, 1)                                                              \
  X("a thermal expansion", "1/K", 0, 0, 0, -1)

#define BASE(m, kg, s, K)                                                                          \
  {                                                                                                \
    { (m) * 12, (kg)*12, (s)*12, (K)*12 }                                                          \
  }

static const struct {
  const char *symbol;
  unit value;
} units[] = {
#define X(symbol, factor, m, kg, s, K) {symbol, {BASE(m, kg, s, K), factor}},
    UNIT_SYMBOLS(X)
#undef X
};

static const char *const symbols[] = {
#define X(symbol, factor, m, kg, s, K) symbol,
    UNIT_SYMBOLS(X)
#undef X
};

static const struct {
  const char *words, *unit;
  dimension dim;
} words[] = {
#define X(phrase, unit, m, kg, s, K) {phrase, unit, BASE(m, kg, s, K)},
    DIMENSION_WORDS(X)
#undef X
    /* the only common quantity with a fractional exponent */
    {"a fracture toughness", "Pa*sqrt(m)", {{-6, 12, -24, 0}}},
};

enum {
  UNIT_COUNT = sizeof(units) / sizeof(units[0]),
  WORD_COUNT = sizeof(words) / sizeof(words[0])
};

/* --- arithmetic ------------------------------------------------------------------------------- */

bool dim_equal(dimension a, dimension b) {
  return memcmp(a.twelfths, b.twelfths, sizeof(a.twelfths)) == 0;
}

bool dim_is_none(dimension a) {
  return dim_equal(a, DIMENSIONLESS);
}

static short clamp_exponent(long twelfths) {
  if (twelfths > LARGEST_TWELFTHS) return LARGEST_TWELFTHS;
  if (twelfths < -LARGEST_TWELFTHS) return -LARGEST_TWELFTHS;
  return (short)twelfths;
}

dimension dim_mul(dimension a, dimension b) {
  for (int i = 0; i < BASE_COUNT; i++)
    a.twelfths[i] = clamp_exponent((long)a.twelfths[i] + b.twelfths[i]);
  return a;
}

dimension dim_div(dimension a, dimension b) {
  for (int i = 0; i < BASE_COUNT; i++)
    a.twelfths[i] = clamp_exponent((long)a.twelfths[i] - b.twelfths[i]);
  return a;
}

bool dim_pow(dimension a, int numerator, int denominator, dimension *result) {
  if (denominator == 0) return false;
  for (int i = 0; i < BASE_COUNT; i++) {
    long long product = (long long)a.twelfths[i] * numerator;
    if (product % denominator != 0) return false;
    long long exponent = product / denominator;
    if (exponent > LARGEST_TWELFTHS || exponent < -LARGEST_TWELFTHS) return false;
    result->twelfths[i] = (short)exponent;
  }
  return true;
}

/* --- reading a unit --------------------------------------------------------------------------- */

typedef struct reader {
  const char *at, *end;
  const char *bad; /* NULL, or where it went wrong */
  size_t bad_length;
  int depth;
} reader;

static bool fail(reader *r, const char *from, const char *to) {
  if (!r->bad) {
    r->bad = from;
    r->bad_length = (size_t)(to - from);
  }
  return false;
}

static void skip_blanks(reader *r) {
  while (r->at < r->end && (*r->at == ' ' || *r->at == '\t'))
    r->at++;
}

static bool take(reader *r, const char *token) {
  size_t length = strlen(token);
  if ((size_t)(r->end - r->at) < length || memcmp(r->at, token, length) != 0) return false;
  r->at += length;
  return true;
}

static bool read_whole(reader *r, int *value) {
  const char *begin = r->at;
  *value = 0;
  for (; r->at < r->end && isdigit((unsigned char)*r->at); r->at++)
    *value = *value < 10000 ? *value * 10 + (*r->at - '0') : 10000; /* far too large either way */
  return r->at > begin;
}

/* 2, -2, 0.5, (1/2), (-1/3): a fraction of whole numbers. */
static bool read_exponent(reader *r, int *numerator, int *denominator) {
  const char *begin = r->at;
  bool parenthesis = take(r, "(");
  int sign = take(r, "-") ? -1 : (take(r, "+"), 1);
  *denominator = 1;
  if (!read_whole(r, numerator)) return fail(r, begin, r->end);
  if (take(r, ".")) {
    while (r->at < r->end && isdigit((unsigned char)*r->at) && *denominator < 10000) {
      *numerator = *numerator * 10 + (*r->at++ - '0');
      *denominator *= 10;
    }
  } else if (parenthesis && take(r, "/") && !read_whole(r, denominator)) {
    return fail(r, begin, r->end);
  }
  if (parenthesis && !take(r, ")")) return fail(r, begin, r->end);
  *numerator *= sign;
  return true;
}

static bool read_product(reader *r, unit *result);

static bool is_symbol_byte(char c) {
  unsigned char byte = (unsigned char)c;
  return isalnum(byte) || byte >= 0x80 || byte == '_' || byte == '%';
}

static bool read_symbol(reader *r, unit *result) {
  const char *begin = r->at;
  while (r->at < r->end && is_symbol_byte(*r->at)) {
    if (r->end - r->at > 1 && memcmp(r->at, "\xC2\xB7", 2) == 0) break;
    r->at++;
  }
  size_t length = (size_t)(r->at - begin);
  for (int i = 0; i < UNIT_COUNT; i++)
    if (strlen(units[i].symbol) == length && memcmp(units[i].symbol, begin, length) == 0) {
      *result = units[i].value;
      return true;
    }
  return fail(r, begin, length ? r->at : r->end);
}

/* What stands behind an open parenthesis, with the closing one. */
static bool read_in_parentheses(reader *r, const char *begin, unit *result) {
  if (++r->depth > DEEPEST_PARENTHESIS) return fail(r, begin, r->end);
  if (!read_product(r, result)) return false;
  if (!take(r, ")")) return fail(r, begin, r->end);
  r->depth--;
  return true;
}

static bool take_root(reader *r, const char *begin, unit *result) {
  if (!dim_pow(result->dim, 1, 2, &result->dim)) return fail(r, begin, r->at);
  result->factor = sqrt(result->factor);
  return true;
}

static bool read_factor(reader *r, unit *result) {
  const char *begin = r->at;
  if (take(r, "sqrt(")) {
    if (!read_in_parentheses(r, begin, result) || !take_root(r, begin, result)) return false;
  } else if (take(r, "(")) {
    if (!read_in_parentheses(r, begin, result)) return false;
  } else if (!read_symbol(r, result)) {
    return false;
  }
  skip_blanks(r);
  if (!take(r, "**") && !take(r, "^")) return true;
  skip_blanks(r);
  int numerator, denominator;
  if (!read_exponent(r, &numerator, &denominator)) return false;
  if (!dim_pow(result->dim, numerator, denominator, &result->dim)) return fail(r, begin, r->at);
  result->factor = power_of(result->factor, (double)numerator / denominator);
  return true;
}

/* After a slash a product without a sign is refused: "J/kg K" means two things to two people. */
static bool read_product(reader *r, unit *result) {
  skip_blanks(r);
  if (!read_factor(r, result)) return false;
  for (bool divided = false;;) {
    skip_blanks(r);
    bool blank = r->at[-1] == ' ' || r->at[-1] == '\t';
    if (r->at == r->end || *r->at == ')') return true;
    const char *begin = r->at;
    bool divide = take(r, "/");
    bool sign = divide || take(r, "*") || take(r, "\xC2\xB7");
    if (!sign && !take(r, ".") && !blank) return fail(r, begin, r->end);
    if (!sign && divided) return fail(r, begin, r->end);
    skip_blanks(r);
    unit factor;
    if (!read_factor(r, &factor)) return false;
    result->dim = divide ? dim_div(result->dim, factor.dim) : dim_mul(result->dim, factor.dim);
    result->factor = divide ? result->factor / factor.factor : result->factor * factor.factor;
    divided |= divide;
  }
}

bool unit_parse(const char *text, size_t length, unit *result, const char **bad,
                size_t *bad_length) {
  reader r = {text, text + length, NULL, 0, 0};
  if (!read_product(&r, result)) {
    if (!r.bad) fail(&r, r.at, r.end);
  } else if (r.at < r.end) {
    fail(&r, r.at, r.end);
  } else if (!isfinite(result->factor) || result->factor == 0) {
    fail(&r, text, r.end);
  }
  *bad = r.bad;
  *bad_length = r.bad_length;
  return !r.bad;
}

const char *const *unit_symbols(int *count) {
  *count = UNIT_COUNT;
  return symbols;
}

/* --- writing ---------------------------------------------------------------------------------- */

static int word_find(dimension d) {
  for (int i = 0; i < WORD_COUNT; i++)
    if (dim_equal(words[i].dim, d)) return i;
  return -1;
}

static size_t append(char *text, size_t size, size_t used, const char *part) {
  size_t length = strlen(part);
  if (used + 1 >= size) return used;
  if (length > size - 1 - used) length = size - 1 - used;
  memcpy(text + used, part, length);
  text[used + length] = '\0';
  return used + length;
}

/* "m", "m^2", "m^(3/2)" or "sqrt(m)" for a positive exponent. */
static void power_text(const char *base, int twelfths, char *text, size_t size) {
  int denominator = 12;
  for (int divisor = 12; divisor > 1; divisor--)
    while (twelfths % divisor == 0 && denominator % divisor == 0) {
      twelfths /= divisor;
      denominator /= divisor;
    }
  if (denominator == 2 && twelfths == 1)
    snprintf(text, size, "sqrt(%s)", base);
  else if (denominator > 1)
    snprintf(text, size, "%s^(%d/%d)", base, twelfths, denominator);
  else if (twelfths > 1)
    snprintf(text, size, "%s^%d", base, twelfths);
  else
    snprintf(text, size, "%s", base);
}

/* "kg*m/s^2": every factor below the line after a slash of its own, so it reads back as written. */
static void base_text(dimension d, char *text, size_t size) {
  static const char *const bases[BASE_COUNT] = {"m", "kg", "s", "K"};
  static const int order[BASE_COUNT] = {1, 0, 2, 3};
  size_t used = 0;
  char power[32];
  for (int sign = 1; sign >= -1; sign -= 2) {
    if (sign < 0 && used == 0) used = append(text, size, used, "1");
    for (int k = 0; k < BASE_COUNT; k++) {
      int twelfths = d.twelfths[order[k]] * sign;
      if (twelfths <= 0) continue;
      if (sign < 0 || used > 0) used = append(text, size, used, sign < 0 ? "/" : "*");
      power_text(bases[order[k]], twelfths, power, sizeof(power));
      used = append(text, size, used, power);
    }
  }
}

void dim_unit(dimension d, char *text, size_t size) {
  if (size == 0) return;
  text[0] = '\0';
  int word = word_find(d);
  if (word >= 0)
    append(text, size, 0, words[word].unit);
  else
    base_text(d, text, size);
}

void dim_describe(dimension d, char *text, size_t size) {
  int word = word_find(d);
  char si_unit[128];
  dim_unit(d, si_unit, sizeof(si_unit));
  if (dim_is_none(d))
    snprintf(text, size, "%s", words[word].words);
  else if (word >= 0)
    snprintf(text, size, "%s (%s)", words[word].words, si_unit);
  else
    snprintf(text, size, "a quantity in %s", si_unit);
}

bool unit_is_pure(const char *symbol) {
  return !symbol || !*symbol || strcmp(symbol, "1") == 0;
}

dimension dimension_of(const char *unit_text) {
  unit u = {DIMENSIONLESS, 1};
  const char *bad;
  size_t length;
  const bool good = unit_parse(unit_text, strlen(unit_text), &u, &bad, &length);
  assert(good || unit_is_pure(unit_text));
  (void)good;
  return u.dim;
}

bool unit_is_whole(const char *text, size_t length) {
  unit u;
  const char *bad;
  size_t bad_length;
  return length > 0 && unit_parse(text, length, &u, &bad, &bad_length);
}
