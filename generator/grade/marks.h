/* What an answer got, item by item and in words; and its way from the process that judged it. */
#ifndef PERILAT_GENERATOR_MARKS_H
#define PERILAT_GENERATOR_MARKS_H

#include <stdbool.h>
#include <stdio.h>

#include "dsl/base/arena.h"

typedef struct item_mark {
  bool judged;
  double share;   /* of its points, 0 to 1 */
  int passed, of; /* its parts: paths, states */
  double value;   /* what was measured; NaN: nothing */
  char *words;    /* sentences, a line each, or NULL */
  char *state;    /* rows of the first state that differs, or NULL */
  char *curve;    /* both curves as SVG, or NULL */
} item_mark;

typedef struct text_list {
  char **items; /* [count] */
  int count;
} text_list;

typedef struct marks {
  arena *memory;
  const char *name; /* of the answer */
  item_mark *items;
  int item_count;
  int errors, warnings, holes; /* of `perilat check` */
  text_list messages;          /* its errors as they are printed */
  text_list advice;            /* its warnings, which cost nothing */
  char *sentence;              /* of a known wrong law, or NULL */
  int known;                   /* which one; -1: none */
  int cases, reached;          /* conditions of the law, and those that were seen true and false */
  text_list notes;             /* sentences that cost nothing */
  const char *trouble;         /* why it was not judged to the end, or NULL */
  double seconds;
  bool ended;
} marks;

/* X(code): what a record says */
#define MARK_RECORDS(X)                                                                            \
  X(MARK)                                                                                          \
  X(WORDS) X(STATE) X(CURVE) X(CHECKED) X(MESSAGE) X(ADVICE) X(SENTENCE) X(NOTE) X(CASES) X(END)
typedef enum mark_record {
#define X(code) RECORD_##code,
  MARK_RECORDS(X)
#undef X
      RECORD_COUNT
} mark_record;

void marks_open(marks *m, const char *name, int item_count);
void marks_close(marks *m);

/* One record; text may be NULL. */
void record_write(FILE *out, mark_record what, int item, const double numbers[4], const char *text);
/* Takes the records of `size` bytes into the marks; whatever they hold, only what is whole and
   within bounds is taken. Texts come without control characters. */
void records_read(marks *m, const char *data, size_t size);

#endif
