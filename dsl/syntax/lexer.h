/* The words of a text, one after the other, each with its span. */
#ifndef PERILAT_DSL_LEXER_H
#define PERILAT_DSL_LEXER_H

#include "dsl/syntax/parser.h"

/* Begins with bytes `begin` .. length of a text, which must live until lexer_close. */
void lexer_open(parsing *p, const char *text, size_t begin, size_t length);
void lexer_close(parsing *p);
/* The next token, its value and where it stands. */
int model_lex(MODEL_STYPE *value, span *where, parsing *p);

#endif
