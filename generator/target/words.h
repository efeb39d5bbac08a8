/* The words of the target: every piece of C that loops and expressions are made of, under a name;
   `$1`, `$2` ... stand for what differs. A second target is one more table of words (words_c.h),
   and a form for its loops.

       say(e, SAY_STORE, "  ", "at_force_0[q]", "N*e_x")     adds "  at_force_0[q] = N*e_x;\n" */
#ifndef PERILAT_GENERATOR_WORDS_H
#define PERILAT_GENERATOR_WORDS_H

#include "generator/target/c_text.h"
#include "generator/target/words_c.h"

typedef enum word {
#define X(name, text) SAY_##name,
  C_WORDS(X)
#undef X
} word;
/* A word and its pieces: $1 is pieces[1]; those behind the last are NULL. */
#define WORDS_OF(name, ...)                                                                        \
  name, (const char *const[10]) {                                                                  \
    NULL, __VA_ARGS__                                                                              \
  }

void words_add(c_text *out, word w, const char *const *pieces);
/* The same as a text of its own. */
const char *words_text(arena *memory, word w, const char *const *pieces);
/* `list`, the separator and `item`; `item` where the list is NULL. */
const char *words_join(arena *memory, const char *list, const char *separator, const char *item);

/* Takes the names that words use in a function. */
void words_reserve(c_names *names);

#endif
