#include "generator/page/html.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/characters.h"
#include "dsl/base/units.h"
#include "runtime/plot/canvas.h"

/* A browser would make a line end of its own of \r. */
static void put_character(FILE *out, char c) {
  if (c == '\r')
    fputs("\\r", out);
  else
    markup_put(out, c);
}

void html_bytes(FILE *out, const char *text, size_t length) {
  for (size_t at = 0; at < length;) {
    const shown_character c = character_shown(text + at, length - at);
    for (const char *shown = c.text; *shown; shown++)
      put_character(out, *shown);
    at += c.length;
  }
}

void html_text(FILE *out, const char *text) {
  html_bytes(out, text, strlen(text));
}

void html_print(FILE *out, const char *format, ...) {
  char *text = NULL;
  size_t length = 0;
  FILE *memory = must_open_text(&text, &length);
  va_list list;
  va_start(list, format);
  vfprintf(memory, format, list);
  va_end(list);
  must_close_text(memory);
  html_bytes(out, text, length);
  free(text);
}

/* The value as it is shown, and its unit, "" without one. */
static double shown_quantity(double value, const char *si_unit, const char **shown) {
  double factor;
  *shown = readable_unit(si_unit, fabs(value), &factor);
  if (value == 0) factor = 1, *shown = si_unit;
  if (unit_is_pure(*shown)) *shown = "";
  return value * factor + 0.0;
}

const char *html_quantity(double value, const char *si_unit, char text[HTML_QUANTITY]) {
  const char *unit_text;
  const double shown = shown_quantity(value, si_unit, &unit_text);
  snprintf(text, HTML_QUANTITY, "%.6g%s%.60s", shown, *unit_text ? " " : "", unit_text);
  return text;
}

/* The digits of an exponent raised; where it ends. */
static const char *put_raised(FILE *out, const char *at) {
  static const char *const digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  if (*at == '-') fputs("⁻", out);
  at += *at == '-' || *at == '+';
  for (; isdigit((unsigned char)*at); at++)
    fputs(digits[*at - '0'], out);
  return at;
}

static bool is_whole_exponent(const char *at) {
  at += *at == '-' || *at == '+';
  const size_t digits = strspn(at, "0123456789");
  return digits > 0 && at[digits] != '.' && at[digits] != '/';
}

void html_unit(FILE *out, const char *unit_text) {
  for (const char *at = unit_text; *at;) {
    const size_t sign = strncmp(at, "**", 2) == 0 ? 2 : *at == '^';
    if (sign && is_whole_exponent(at + sign))
      at = put_raised(out, at + sign);
    else if (sign == 2) {
      fputc('^', out);
      at += 2;
    } else if (*at == '*') {
      fputs("·", out);
      at++;
    } else {
      const size_t length = utf8_length(at, strlen(at));
      html_bytes(out, at, length ? length : 1);
      at += length ? length : 1;
    }
  }
}

void html_put_quantity(FILE *out, double value, const char *si_unit) {
  const char *unit_text;
  const double shown = shown_quantity(value, si_unit, &unit_text);
  html_print(out, "%.6g%s", shown, *unit_text ? " " : "");
  html_unit(out, unit_text);
}
