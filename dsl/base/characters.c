#define _GNU_SOURCE /* wcwidth */
#include "dsl/base/characters.h"

#include <locale.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <wchar.h>

/* --- bytes ------------------------------------------------------------------------------------ */

static bool continues(char byte) {
  return ((unsigned char)byte & 0xC0) == 0x80;
}

/* Neither overlong forms nor surrogates nor anything beyond U+10FFFF (Unicode 15, table 3-7). */
static bool second_byte_allowed(unsigned char first, unsigned char second) {
  switch (first) {
  case 0xE0:
    return second >= 0xA0;
  case 0xED:
    return second <= 0x9F;
  case 0xF0:
    return second >= 0x90;
  case 0xF4:
    return second <= 0x8F;
  default:
    return true;
  }
}

size_t utf8_length(const char *text, size_t available) {
  if (available == 0) return 0;
  unsigned char first = (unsigned char)text[0];
  size_t length = first < 0x80                     ? 1
                  : first >= 0xC2 && first <= 0xDF ? 2
                  : first >= 0xE0 && first <= 0xEF ? 3
                  : first >= 0xF0 && first <= 0xF4 ? 4
                                                   : 0;
  if (length > available) return 0;
  for (size_t i = 1; i < length; i++)
    if (!continues(text[i])) return 0;
  if (length > 1 && !second_byte_allowed(first, (unsigned char)text[1])) return 0;
  return length;
}

static uint32_t code_point(const char *text, size_t length) {
  static const unsigned char first_bits[] = {0, 0x7F, 0x1F, 0x0F, 0x07};
  uint32_t code = (unsigned char)text[0] & first_bits[length];
  for (size_t i = 1; i < length; i++)
    code = code << 6 | ((unsigned char)text[i] & 0x3F);
  return code;
}

/* --- what is shown ---------------------------------------------------------------------------- */

/* C1 controls are commands to many terminals; the others turn the direction of the text that
 * follows. */
static bool commands(uint32_t code) {
  return (code >= 0x80 && code < 0xA0) || code == 0x061C || code == 0x200E || code == 0x200F ||
         (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
}

/* 0 of what joins the character before it, 2 of wide ones; as the C library knows them. */
static int columns_of(uint32_t code) {
  static _Thread_local locale_t unicode;
  if (!unicode) unicode = newlocale(LC_CTYPE_MASK, "C.UTF-8", (locale_t)0);
  if (!unicode) return 1;
  const locale_t before = uselocale(unicode);
  const int columns = wcwidth((wchar_t)code);
  uselocale(before);
  return columns < 0 ? 1 : columns;
}

static shown_character written_out(const char *format, uint32_t code, size_t length) {
  shown_character c = {.length = length};
  c.columns = snprintf(c.text, sizeof c.text, format, (unsigned)code);
  return c;
}

shown_character character_shown(const char *text, size_t available) {
  const size_t length = utf8_length(text, available);
  const unsigned char first = (unsigned char)text[0];
  if (length == 0) return written_out("\\x%02x", first, 1);
  if (length == 1 && (first < 32 || first == 127) && first != '\t' && first != '\n')
    return written_out("\\x%02x", first, 1);
  const uint32_t code = code_point(text, length);
  if (commands(code)) return written_out("\\u%04x", code, length);
  shown_character c = {.length = length, .columns = code < 0x80 ? 1 : columns_of(code)};
  memcpy(c.text, text, length);
  return c;
}

size_t characters_plain(const char *text, size_t available) {
  size_t n = 0;
  while (n < available && ((text[n] >= 32 && text[n] < 127) || text[n] == '\n' || text[n] == '\t'))
    n++;
  return n;
}

void characters_show(FILE *out, const char *text, size_t length) {
  for (size_t i = 0; i < length;) {
    const size_t plain = characters_plain(text + i, length - i);
    fwrite(text + i, 1, plain, out);
    i += plain;
    if (i == length) break;
    const shown_character c = character_shown(text + i, length - i);
    fputs(c.text, out);
    i += c.length;
  }
}

const char *name_shown(const char *name) {
  enum { NAMES = 4, LONGEST = 600, ROOM = sizeof((shown_character){0}).text + 3 };
  static _Thread_local char names[NAMES][LONGEST];
  static _Thread_local int last;
  char *shown = names[last = (last + 1) % NAMES];
  size_t used = 0, left = strlen(name);
  while (left > 0 && used + ROOM < LONGEST) {
    shown_character c = character_shown(name, left);
    if (*c.text == '\t' || *c.text == '\n') c = written_out("\\x%02x", (unsigned char)*name, 1);
    used += (size_t)sprintf(shown + used, "%s", c.text);
    name += c.length;
    left -= c.length;
  }
  strcpy(shown + used, left > 0 ? "..." : "");
  return shown;
}

bool text_ends_in(const char *text, const char *tail) {
  size_t n = strlen(text), m = strlen(tail);
  return n > m && strcmp(text + n - m, tail) == 0;
}

void markup_put(FILE *out, char c) {
  switch (c) {
  case '&':
    fputs("&amp;", out);
    break;
  case '<':
    fputs("&lt;", out);
    break;
  case '>':
    fputs("&gt;", out);
    break;
  case '"':
    fputs("&quot;", out);
    break;
  case '\'':
    fputs("&#39;", out);
    break;
  default:
    fputc(c, out);
  }
}
