/* A line of a source under a message, with the place meant underlined. On a terminal it is cut
   around the place to what there is room for, elsewhere to what can still be read. */
#ifndef PERILAT_DSL_QUOTE_H
#define PERILAT_DSL_QUOTE_H

#include <stdio.h>

#include "dsl/base/source.h"

/* Prints the line on which `where` begins, and the line with the caret:
       7 |   x = alfa2*stretch
         |       ^~~~~             */
void quote_line(const source_set *sources, span where, FILE *out);

#endif
