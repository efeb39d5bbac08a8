/* Overrides: "group.key=value" texts that replace or add keys of the groups read from a deck;
   "group.key=" takes one out. */
#ifndef PERILAT_RUNTIME_DECK_SET_H
#define PERILAT_RUNTIME_DECK_SET_H

#include "runtime/deck/deck_schema.h"

/* Keys under a former name get their present one; both in one group are an error. */
void deck_present_names(namelist *n, const deck_grammar *grammar, diagnostics *d);

/* Changes the groups in place; `grammar` says which there may be. The value follows the deck's
   grammar; since shells remove quotes, a value without any that is no number or logical value is
   taken as a text (as several, split at commas, where the key takes several). Each text becomes a
   source named "--set". */
void deck_set(arena *a, source_set *sources, namelist *n, const deck_grammar *grammar,
              const deck_override *overrides, int count, diagnostics *d);

/* The key that "group.key" is in an override: NULL when the group has none, or after a message. */
const namelist_key *deck_find_key(arena *a, source_set *sources, namelist *n,
                                  const deck_grammar *grammar, const char *name, diagnostics *d);

#endif
