/* The table of a law's names: entered where they are declared, found again where expressions read
   them. The same word may stand for a quantity, a function, and a choice of an option. */
#ifndef PERILAT_DSL_NAMES_H
#define PERILAT_DSL_NAMES_H

#include "dsl/semantics/checker.h"

/* Empty; or with all that a law can read without declaring it. */
void names_open(checker *ck);
void names_begin(checker *ck);
void names_end(checker *ck);
entry *names_add(checker *ck, name_space space, const char *key, symbol what);
/* Enters what is built in, of enum builtin_quantity. */
void names_add_quantity(checker *ck, int quantity);
entry *names_find(const checker *ck, name_space space, const char *name);
/* Several options may have choices of the same name. */
entry *names_find_choice(const checker *ck, const symbol *option, const char *name);
/* Adds "did you mean" from the names of a space. */
void names_suggest(checker *ck, name_space space, const char *name);

/* Resolves a name in an expression, wherever it is declared; NULL after a message. */
entry *names_resolve(checker *ck, expr *e);
/* Is it declared only below the statement that reads it? States have their old value there. */
bool names_is_below(const checker *ck, const entry *e);

/* Does not change in time. */
bool is_fixed(const symbol *s);

#endif
