/* The names of a law: declared by its statements, found again in expressions. */
#ifndef PERILAT_DSL_NAMES_H
#define PERILAT_DSL_NAMES_H

#include "dsl/semantics/checker.h"

void names_begin(checker *ck);
void names_end(checker *ck);
/* Declares what every statement declares; duplicates and reserved names are reported. */
void names_declare(checker *ck);
entry *names_find(const checker *ck, name_space space, const char *name);
/* Several options may have choices of the same name. */
entry *names_find_choice(const checker *ck, const symbol *option, const char *name);
/* Adds "did you mean" from the names of a space. */
void names_suggest(checker *ck, name_space space, const char *name);

/* Resolves a name in an expression, wherever it is declared; NULL after a message. */
entry *names_resolve(checker *ck, expr *e);
/* Is it declared only below the statement that reads it? A state has its value of the last step there. */
bool names_is_below(const checker *ck, const entry *e);

/* Does not change in time. */
bool is_fixed(const symbol *s);

#endif
