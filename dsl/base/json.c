#include "dsl/base/json.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "dsl/base/characters.h"
#include "dsl/base/digits.h"

void json_begin(json *j, FILE *out) {
  *j = (json){.out = out};
}

void json_end(json *j) {
  assert(j->depth == 0 && !j->after_key);
  fputc('\n', j->out);
}

static void new_line(json *j) {
  fprintf(j->out, "\n%*s", 2 * j->depth, "");
}

/* What stands between a value and the one before it. */
static void before_value(json *j) {
  if (j->after_key) {
    j->after_key = false;
    return;
  }
  if (j->depth == 0) return;
  if (j->filled[j->depth - 1]) fputc(',', j->out);
  j->filled[j->depth - 1] = true;
  new_line(j);
}

static void open_with(json *j, char bracket) {
  before_value(j);
  assert(j->depth < JSON_DEEPEST);
  fputc(bracket, j->out);
  j->filled[j->depth++] = false;
}

static void close_with(json *j, char bracket) {
  assert(j->depth > 0 && !j->after_key);
  bool filled = j->filled[--j->depth];
  if (filled) new_line(j);
  fputc(bracket, j->out);
}

void json_object(json *j) {
  open_with(j, '{');
}
void json_object_end(json *j) {
  close_with(j, '}');
}
void json_array(json *j) {
  open_with(j, '[');
}
void json_array_end(json *j) {
  close_with(j, ']');
}

/* --- texts ------------------------------------------------------------------------------------ */

static void put_ascii(json *j, unsigned char byte) {
  static const char named[] = "\"\"\\\\\nn\tt\rr\bb\ff";
  for (size_t i = 0; i + 1 < sizeof named; i += 2)
    if ((unsigned char)named[i] == byte) {
      fprintf(j->out, "\\%c", named[i + 1]);
      return;
    }
  if (byte < 32 || byte == 127)
    fprintf(j->out, "\\u%04x", byte);
  else
    fputc(byte, j->out);
}

static void put_text(json *j, const char *text, size_t length) {
  fputc('"', j->out);
  for (size_t i = 0; i < length;) {
    size_t n = utf8_length(text + i, length - i);
    if (n == 1)
      put_ascii(j, (unsigned char)text[i]);
    else if (n > 1)
      fwrite(text + i, 1, n, j->out);
    else
      fputs("\xEF\xBF\xBD", j->out);
    i += n ? n : 1;
  }
  fputc('"', j->out);
}

void json_key(json *j, const char *name) {
  before_value(j);
  put_text(j, name, strlen(name));
  fputs(": ", j->out);
  j->after_key = true;
}

void json_bytes(json *j, const char *text, size_t length) {
  before_value(j);
  put_text(j, text, length);
}

void json_text(json *j, const char *text) {
  if (text)
    json_bytes(j, text, strlen(text));
  else
    json_null(j);
}

/* --- other values ----------------------------------------------------------------------------- */

void json_number(json *j, double number) {
  if (!isfinite(number)) {
    json_null(j);
    return;
  }
  char text[DIGITS_TEXT];
  fewest_digits(number, text);
  char *comma = strchr(text, ','); /* the decimal sign of some languages */
  if (comma) *comma = '.';
  before_value(j);
  fputs(text, j->out);
}

void json_integer(json *j, long number) {
  before_value(j);
  fprintf(j->out, "%ld", number);
}

void json_bool(json *j, bool value) {
  before_value(j);
  fputs(value ? "true" : "false", j->out);
}

void json_null(json *j) {
  before_value(j);
  fputs("null", j->out);
}

/* --- keys and documents ----------------------------------------------------------------------- */

void json_put_text(json *j, const char *name, const char *text) {
  json_key(j, name);
  json_text(j, text);
}
void json_put_number(json *j, const char *name, double number) {
  json_key(j, name);
  json_number(j, number);
}
void json_put_integer(json *j, const char *name, long number) {
  json_key(j, name);
  json_integer(j, number);
}
void json_put_bool(json *j, const char *name, bool value) {
  json_key(j, name);
  json_bool(j, value);
}
void json_put_object(json *j, const char *name) {
  json_key(j, name);
  json_object(j);
}
void json_put_array(json *j, const char *name) {
  json_key(j, name);
  json_array(j);
}

void json_document(json *j, FILE *out, const char *version) {
  json_begin(j, out);
  json_object(j);
  json_put_integer(j, "schema", JSON_SCHEMA);
  json_put_text(j, "perilat", version);
}

void json_document_end(json *j) {
  json_object_end(j);
  json_end(j);
}
