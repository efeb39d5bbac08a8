/* Small parts of C source text: a growable buffer, literals that read back to the same value, and
   identifiers that are safe and unique. What goes into a C file passes through here. */
#ifndef PERILAT_GENERATOR_C_TEXT_H
#define PERILAT_GENERATOR_C_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "dsl/base/arena.h"
#include "dsl/base/name_index.h"

typedef struct c_text {
  char *text; /* NUL-terminated once something was added; malloc'ed */
  size_t length, capacity;
} c_text;

void c_text_add(c_text *t, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* String literal; all but plain letters, digits and a few harmless marks as octal escapes. NULL
 * gives 0. */
void c_text_string(c_text *t, const char *text);
/* Double literal that reads back to the same bits, in decimal; infinities and NaN as compiler
   built-ins. Negative ones stand in parentheses. */
void c_text_number(c_text *t, double value);

/* The identifiers taken in one scope. */
typedef struct c_names {
  name_index taken;
  arena *memory; /* of the names; NULL while there are none */
} c_names;

void c_names_clear(c_names *n);
/* Marks `name` as taken; false when it already was. */
bool c_names_reserve(c_names *n, const char *name);
/* An identifier made of `wish` that is neither taken nor a word of C, a predefined macro or a name
   of the prelude; only letters, digits and underscores. It is taken from then on and lives as long
   as the table. */
const char *c_names_make(c_names *n, const char *wish);

#endif
