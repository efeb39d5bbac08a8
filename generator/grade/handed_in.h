/* An answer as it was handed in: a stranger's file, read with care. */
#ifndef PERILAT_GENERATOR_HANDED_IN_H
#define PERILAT_GENERATOR_HANDED_IN_H

#include <stdint.h>

#include "dsl/base/arena.h"

typedef struct handed_in {
  const char *name;   /* of the student, or of the file */
  const char *file;   /* NULL: there is none */
  const char *folder; /* its further laws may be included; NULL: none may */
} handed_in;

/* What a stranger's file holds. */
typedef struct handed_text {
  const char *bad; /* why it is not judged, or NULL */
  const char *text;
  size_t length;
} handed_text;

/* Reads an ordinary file of a bearable size, not a link (NULL: there is none), into the arena. */
handed_text handed_text_read(arena *a, const char *file);
/* As above; a file that is empty or no text is bad, too. */
handed_text handed_answer_read(arena *a, const char *file);
/* The same of the same answer, wherever its file lies and however its lines end. */
uint64_t handed_text_seed(const handed_text *t);
/* The text with one blank, or one end of a line, for all that are beside each other, and without
   comments: laws that have the same are the same. NULL where it may include other texts. */
char *handed_text_bare(arena *a, const handed_text *t);

#endif
