/* Texts that a text includes, each once and none within itself. The parser runs them where the line
   stands: statement 1, `include "b.plm"`, statement 2 give 1, all of b.plm, 2. */
#ifndef PERILAT_DSL_INCLUDES_H
#define PERILAT_DSL_INCLUDES_H

#include "dsl/syntax/parsing.h"

/* The text that `s` includes, to be parsed; NULL after a message, or where it was read before. */
parsing *include_open(parsing *p, const stmt *s);
/* After it has been parsed: `p` goes on behind its statements. */
void include_close(parsing *p, parsing *inner);

#endif
