/* All groups that a deck may hold, with their keys and checks: the table that drives reading,
   suggestions, overrides and the reference. */
#ifndef PERILAT_RUNTIME_DECK_GROUPS_H
#define PERILAT_RUNTIME_DECK_GROUPS_H

#include <stdio.h>

#include "runtime/deck/deck_schema.h"

/* In the order of DECK_GROUPS. */
extern const deck_group_info *const deck_groups[DECK_GROUP_COUNT];
extern const deck_grammar deck_grammar_of_decks;

/* Every group and key of a grammar with its value, unit, default and meaning, as Markdown. */
void deck_reference(const deck_grammar *of, FILE *out);

#endif
