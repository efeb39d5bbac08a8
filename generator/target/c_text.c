#include "generator/target/c_text.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/powers.h"

#define LONGEST_NAME 60 /* characters kept of a model's name */

static void make_room(c_text *t, size_t more) {
  if (t->length + more + 1 <= t->capacity) return;
  t->capacity = 2 * (t->length + more + 1);
  t->text = must_realloc(t->text, t->capacity);
}

void c_text_add(c_text *t, const char *format, ...) {
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  int length = vsnprintf(NULL, 0, format, arguments);
  va_end(arguments);
  if (length > 0) {
    make_room(t, (size_t)length);
    vsnprintf(t->text + t->length, (size_t)length + 1, format, again);
    t->length += (size_t)length;
  }
  va_end(again);
}

static bool is_plain(unsigned char c) {
  return (c < 128 && isalnum(c)) || (c && strchr(" _+-*/^.,;:()[]'=<>", c));
}

void c_text_string(c_text *t, const char *text) {
  if (!text) {
    c_text_add(t, "0");
    return;
  }
  c_text_add(t, "\"");
  for (const unsigned char *c = (const unsigned char *)text; *c; c++)
    c_text_add(t, is_plain(*c) ? "%c" : "\\%03o", *c);
  c_text_add(t, "\"");
}

void c_text_number(c_text *t, double value) {
  if (!isfinite(value)) {
    const char *call = isnan(value) ? "__builtin_nan(\"\")" : "__builtin_inf()";
    c_text_add(t, signbit(value) ? "(-%s)" : "%s", call);
    return;
  }
  char digits[40];
  double size = fabs(value);
  int whole = size >= 1 && size < 1e9 ? decade_of(size) + 1 : 1; /* 20.0 rather than 2e+01 */
  for (int precision = whole; precision <= 17; precision++) {
    snprintf(digits, sizeof digits, "%.*g", precision, size);
    if (strtod(digits, NULL) == size) break;
  }
  if (!strpbrk(digits, ".e")) strcat(digits, ".0");
  c_text_add(t, signbit(value) ? "(-%s)" : "%s", digits);
}

/* --- identifiers ------------------------------------------------------------------------------ */

static const char *const taken_by_c[] = {
    "auto",     "break",     "case",     "char",      "const",        "continue",      "default",
    "do",       "double",    "else",     "enum",      "extern",       "float",         "for",
    "goto",     "if",        "inline",   "int",       "long",         "register",      "restrict",
    "return",   "short",     "signed",   "sizeof",    "static",       "struct",        "switch",
    "typedef",  "union",     "unsigned", "void",      "volatile",     "while",         "asm",
    "typeof",   "linux",     "unix",     "i386",      "sun",          "mips",          "sparc",
    "vax",      "arm",       "PIC",      "pic",       "bool",         "true",          "false",
    "nullptr",  "alignas",   "alignof",  "constexpr", "thread_local", "static_assert", "int64_t",
    "int32_t",  "int16_t",   "int8_t",   "uint64_t",  "uint32_t",     "uint16_t",      "uint8_t",
    "intptr_t", "uintptr_t", "intmax_t", "uintmax_t", "NULL",         "SIZE_MAX"};

/* Names that begin so belong to C, to its headers' macros, to the prelude or to the arrays of a
 * strip. */
static const char *const taken_prefixes[] = {"_",      "pl_",   "PL_",  "INT",      "UINT",
                                             "WCHAR_", "WINT_", "SIG_", "PTRDIFF_", "at_"};

/* Names that loops number: slot_0. */
static const char *const numbered[] = {"to",         "far",        "value",   "slot",
                                       "plane",      "before",     "settled", "unsettled",
                                       "old_filled", "new_filled", "size",    "largest"};

/* A stem alone gives its length, and so does one with its number; other names 0. */
static size_t stem_of(const char *name) {
  for (size_t k = 0; k < sizeof numbered / sizeof *numbered; k++) {
    const size_t n = strlen(numbered[k]);
    if (strncmp(name, numbered[k], n) != 0) continue;
    if (!name[n]) return n;
    if (name[n] == '_' && name[n + 1] && !name[n + 1 + strspn(name + n + 1, "0123456789")])
      return n;
  }
  return 0;
}

static bool is_taken(const char *name) {
  for (size_t k = 0; k < sizeof taken_by_c / sizeof *taken_by_c; k++)
    if (strcmp(name, taken_by_c[k]) == 0) return true;
  for (size_t k = 0; k < sizeof taken_prefixes / sizeof *taken_prefixes; k++)
    if (strncmp(name, taken_prefixes[k], strlen(taken_prefixes[k])) == 0) return true;
  return stem_of(name) > 0 && name[stem_of(name)];
}

/* The table's own copy of `name`, or NULL when it was taken before. */
static const char *take(c_names *n, const char *name) {
  if (name_index_at(&n->taken, name)) return NULL;
  if (!n->memory) n->memory = arena_new();
  const char *own = arena_text(n->memory, name, strlen(name));
  name_index_add(&n->taken, own, 0);
  return own;
}

bool c_names_reserve(c_names *n, const char *name) {
  return take(n, name) != NULL;
}

void c_names_clear(c_names *n) {
  name_index_clear(&n->taken);
  arena_free(n->memory);
  *n = (c_names){0};
}

const char *c_names_make(c_names *n, const char *wish) {
  char base[LONGEST_NAME + 2], name[LONGEST_NAME + 32];
  size_t length = 0;
  if (isdigit((unsigned char)*wish) || *wish == '_' || !*wish) base[length++] = 'x';
  for (const char *c = wish; *c && length < LONGEST_NAME; c++)
    base[length++] = (unsigned char)*c < 128 && isalnum((unsigned char)*c) ? *c : '_';
  base[length] = 0;
  snprintf(name, sizeof name, is_taken(base) ? "x_%s" : "%s", base);
  snprintf(base, sizeof base, "%.*s", LONGEST_NAME, name);
  const char *made = take(n, name);
  for (unsigned long k = 2; !made; k++) {
    snprintf(name, sizeof name, stem_of(base) ? "x_%s_%lu" : "%s_%lu", base, k);
    made = take(n, name);
  }
  return made;
}
