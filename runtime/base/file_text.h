/* The text of a file that messages point into: read whole, and among their sources once the first
   of them does so. */
#ifndef PERILAT_RUNTIME_FILE_TEXT_H
#define PERILAT_RUNTIME_FILE_TEXT_H

#include <stdbool.h>
#include <stdint.h>

#include "dsl/base/diagnostics.h"

typedef struct file_text {
  char *path;
  const char *text; /* ends with a zero byte */
  size_t length;
  char *owned; /* the text, where it is not one of the sources */
  int source;  /* among the sources, -1 until a message has pointed into it */
} file_text;

/* Takes over `path` (malloc'ed); a source of that name stands for the file. False after a message
   at `where`. To be closed in either case. */
bool file_text_open(file_text *f, char *path, span where, diagnostics *d);
void file_text_close(file_text *f);
/* "cannot read `PATH`: WHY" at `where`; false. */
bool file_text_refuse(const file_text *f, span where, diagnostics *d, const char *why);

/* Puts the text among the sources, where it stays. Its number there. */
int file_text_source(file_text *f, diagnostics *d);
/* Bytes `from` to `to`; the line that holds a byte. */
span file_text_span(file_text *f, const char *from, const char *to, diagnostics *d);
span file_text_line(file_text *f, const char *at, diagnostics *d);

#endif
