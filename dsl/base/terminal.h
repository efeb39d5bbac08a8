/* The program's standard output and error as a terminal has them: how wide, with colours or
   without, and safe from what files hold. Only the program's own control sequences reach a
   terminal. */
#ifndef PERILAT_DSL_TERMINAL_H
#define PERILAT_DSL_TERMINAL_H

#include <stdbool.h>
#include <stdio.h>

/* From here on what is printed is shown as characters.h says, wherever it goes: messages and
   reports are full of names, titles and units from files. For main(). */
void terminal_begin(void);
/* The standard output is data, in a form of its own (JSON, CSV, a law's text): left as it is,
 * unless a terminal shows it. */
void terminal_expect_data(void);

/* From here on what is printed is kept, and not shown: on the standard output, and on the error
   stream. For what is to be shown and stored. */
typedef struct terminal_record {
  FILE *streams[2];
  char *texts[2]; /* malloc'ed; once it has ended */
  size_t lengths[2];
} terminal_record;
void terminal_record_begin(terminal_record *t);
void terminal_record_end(terminal_record *t);
/* Shows what was kept, and lets go of it; lets go of it alone. */
void terminal_record_show(terminal_record *t);
void terminal_record_drop(terminal_record *t);

/* Columns; 0 where `out` is no terminal. */
int terminal_columns(FILE *out);
/* A terminal that understands control sequences. */
bool terminal_is_able(FILE *out);
/* Sends one, "\033[K"; nothing else of the program gets through. */
void terminal_control(FILE *out, const char *sequence);

/* X(what, sequence): what stands out in messages. */
#define TERMINAL_PAINTS(X)                                                                         \
  X(PLAIN, "\033[0m")                                                                              \
  X(PLACE, "\033[1m")                                                                              \
  X(ERROR, "\033[1;31m")                                                                           \
  X(WARNING, "\033[1;33m")                                                                         \
  X(NOTE, "\033[1;36m")                                                                            \
  X(CARET, "\033[1;32m")

typedef enum terminal_paint {
#define X(what, sequence) PAINT_##what,
  TERMINAL_PAINTS(X)
#undef X
} terminal_paint;

/* What follows stands out so, where the terminal has colours and NO_COLOR does not forbid them
 * (no-color.org). */
void terminal_paint_with(FILE *out, terminal_paint paint);

#endif
