/* Source texts and places in them. A span is a byte range of one text; line and column are
   computed only when a message is printed. Texts are held in memory; nothing here opens files. */
#ifndef PERILAT_DSL_SOURCE_H
#define PERILAT_DSL_SOURCE_H

#include <stddef.h>
#include <stdint.h>

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

typedef struct span {
  uint32_t begin; /* first byte */
  uint32_t end;   /* one past the last byte */
  uint16_t file;  /* index into the source_set */
} span;

typedef struct source {
  char *name; /* as the user wrote it: a path or "<text>" */
  char *text; /* NUL-terminated copy */
  size_t length;
  uint32_t *lines;      /* [line_count] where they begin */
  uint32_t *characters; /* before every 1024th byte */
  int line_count;
} source;

typedef struct source_set {
  source *items;
  int count;
} source_set;

typedef struct place {
  int line;   /* from 1 */
  int column; /* from 1, in characters (UTF-8 code points) */
} place;

/* Adds a copy of the text; returns its index for span.file. */
int source_add(source_set *set, const char *name, const char *text, size_t length);
void source_clear(source_set *set);
/* All of a text. */
span source_whole(const source_set *set, int file);

place source_place(const source_set *set, int file, uint32_t offset);
int source_line_number(const source_set *set, int file, uint32_t offset); /* from 1 */
/* Start of the line that holds `offset`, and its length without the line end. */
const char *source_line(const source_set *set, int file, uint32_t offset, size_t *length);
/* Smallest span that covers both (they must be of one file; otherwise the first is returned). */
span span_join(span a, span b);

C_LINKAGE_END

#endif
