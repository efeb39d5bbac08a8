/* Is a text one JSON value (RFC 8259), in valid UTF-8? For tests; knows nothing of the writer. */
#ifndef PERILAT_TESTS_JSON_VALID_H
#define PERILAT_TESTS_JSON_VALID_H

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const char *json_value_end(const char *at, int depth);

static const char *json_blank_end(const char *at) {
  return at + strspn(at, " \t\r\n");
}

static const char *json_string_end(const char *at) {
  if (*at++ != '"') return NULL;
  while (*at != '"') {
    if ((unsigned char)*at < 32) return NULL;
    if (*at++ != '\\') continue;
    if (*at == 'u') {
      if (strspn(at + 1, "0123456789abcdefABCDEF") < 4) return NULL;
      at += 5;
    } else if (*at && strchr("\"\\/bfnrt", *at)) {
      at++;
    } else {
      return NULL;
    }
  }
  return at + 1;
}

static const char *json_number_end(const char *at) {
  at += *at == '-';
  if (*at == '0')
    at++;
  else if (strspn(at, "0123456789") > 0)
    at += strspn(at, "0123456789");
  else
    return NULL;
  if (*at == '.') {
    if (strspn(at + 1, "0123456789") == 0) return NULL;
    at += 1 + strspn(at + 1, "0123456789");
  }
  if (*at == 'e' || *at == 'E') {
    at++;
    at += *at == '+' || *at == '-';
    if (strspn(at, "0123456789") == 0) return NULL;
    at += strspn(at, "0123456789");
  }
  return at;
}

/* Objects and arrays: entries between `open` and `close`, with keys or without. */
static const char *json_list_end(const char *at, char close, bool keys, int depth) {
  at = json_blank_end(at + 1);
  if (*at == close) return at + 1;
  for (;;) {
    if (keys) {
      at = json_string_end(at);
      if (!at) return NULL;
      at = json_blank_end(at);
      if (*at++ != ':') return NULL;
    }
    at = json_value_end(json_blank_end(at), depth + 1);
    if (!at) return NULL;
    at = json_blank_end(at);
    if (*at == close) return at + 1;
    if (*at++ != ',') return NULL;
    at = json_blank_end(at);
  }
}

static const char *json_value_end(const char *at, int depth) {
  static const char *const literals[] = {"true", "false", "null"};
  if (depth > 50) return NULL;
  if (*at == '"') return json_string_end(at);
  if (*at == '{') return json_list_end(at, '}', true, depth);
  if (*at == '[') return json_list_end(at, ']', false, depth);
  for (int i = 0; i < 3; i++)
    if (strncmp(at, literals[i], strlen(literals[i])) == 0) return at + strlen(literals[i]);
  return json_number_end(at);
}

/* By the C library's own decoder: needs a UTF-8 locale, so the rules are spelt out instead. */
static bool is_utf8(const char *text) {
  for (const unsigned char *at = (const unsigned char *)text; *at;) {
    unsigned code;
    int more;
    if (*at < 0x80) {
      code = *at, more = 0;
    } else if ((*at & 0xE0) == 0xC0) {
      code = *at & 0x1F, more = 1;
    } else if ((*at & 0xF0) == 0xE0) {
      code = *at & 0x0F, more = 2;
    } else if ((*at & 0xF8) == 0xF0) {
      code = *at & 0x07, more = 3;
    } else {
      return false;
    }
    static const unsigned least[] = {0, 0x80, 0x800, 0x10000};
    at++;
    for (int i = 0; i < more; i++, at++) {
      if ((*at & 0xC0) != 0x80) return false;
      code = code << 6 | (*at & 0x3F);
    }
    if (code < least[more] || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000)) return false;
  }
  return true;
}

static bool json_is_valid(const char *text) {
  const char *end = json_value_end(json_blank_end(text), 0);
  return end && *json_blank_end(end) == 0 && is_utf8(text);
}

#endif
