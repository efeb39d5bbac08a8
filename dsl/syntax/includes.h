/* Texts that a text includes: found, held to be included once and not by themselves, and read in its place. The parser
   runs them: a.plm, with a line `include "b.plm"` between statements 1 and 2, gives 1, all of b.plm, 2. */
#ifndef PERILAT_DSL_INCLUDES_H
#define PERILAT_DSL_INCLUDES_H

#include "dsl/syntax/parsing.h"

/* The text that `s` includes, ready to be parsed; NULL after a message, or where it has been read before. */
parsing *include_open(parsing *p, const stmt *s);
/* After it has been parsed: `p` goes on behind its statements. */
void include_close(parsing *p, parsing *inner);

#endif
