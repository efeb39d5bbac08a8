/* Words for what the grammar refuses. bison knows which tokens could have stood in a place; the
   user gets one sentence in the language's own words and, for the usual slips, the mend. */
#ifndef PERILAT_DSL_SYNTAX_ERROR_H
#define PERILAT_DSL_SYNTAX_ERROR_H

#include "dsl/syntax/parsing.h"

/* Says what is wrong at `token`, given the tokens that could have stood there. */
void syntax_error(parsing *p, int token, span where, const bool expected[TOKEN_CODES]);
/* A character sequence that no rule of the language begins with. */
void syntax_slip(parsing *p, span where);
/* A number with letters or points stuck to it. */
void syntax_bad_number(parsing *p, span where);

#endif
