/* The lines of a text, in their order: model, kind of law, settings, statements, end. */
#ifndef PERILAT_DSL_LINES_H
#define PERILAT_DSL_LINES_H

#include "dsl/syntax/parsing.h"

void line_model(parsing *p, word name);
void line_end(parsing *p, word of, word name, span where);
void line_law(parsing *p, word first, word second, span where);
/* `crack` in place of the kind of law; it ends with `end crack`. */
void line_crack(parsing *p, span where);
void line_settings(parsing *p, const words *list, span where);
/* True where the statement includes a text, which is then to be read. */
bool line_statement(parsing *p, stmt *s, word text, span where);
/* The present line could not be understood and was skipped. */
void line_broken(parsing *p);

#endif
