/* Values of a deck: numbers with units into SI, texts into choices, each checked against the
 * table's entry. */
#ifndef PERILAT_RUNTIME_DECK_VALUE_H
#define PERILAT_RUNTIME_DECK_VALUE_H

#include "runtime/deck/deck_schema.h"

typedef struct deck_quantity {
  double value;  /* SI; finite */
  bool has_unit; /* a text with a unit; a plain number fits any dimension */
  dimension dim; /* when has_unit */
} deck_quantity;

/* Reads `12.5` or '12.5 mm'. False after a message. */
bool deck_quantity_read(const namelist_value *v, const char *key, deck_quantity *q, diagnostics *d);
/* Both at once, and `bound`. */
bool deck_real_read(const namelist_value *v, const char *key, const char *unit, deck_bound bound,
                    double *value, diagnostics *d);

/* False, with a message, unless the key has exactly `count` values. */
bool deck_values_counted(const namelist_key *key, int count, diagnostics *d);

/* Position of the key's only value among "a|b|c"; -1 after a message. */
int deck_choice_read(arena *a, const namelist_key *key, const char *choices, diagnostics *d);

/* Reads the key into its place in `item` (nothing for DECK_LATER). False after a message. */
bool deck_field_read(arena *a, const deck_key_info *info, const namelist_key *key, void *item,
                     diagnostics *d);
/* Sets every field of the group that has a plain default. */
void deck_defaults(arena *a, const deck_group_info *g, void *item);

/* Which of a group's keys go with which choice of its `shape`, `kind` or `history`. */
typedef struct deck_key_use {
  const char *key;
  unsigned kinds; /* bit k: belongs to choice k */
  bool required;
} deck_key_use;

/* False, with messages, when a written key does not go with choice `kind` or a required one is
   missing. `words` names the choice: "a disc". */
bool deck_keys_fit(const namelist_group *g, const deck_key_use *uses, int count, int kind,
                   const char *words, diagnostics *d);

/* As diag_suggest; without a near name the hint lists all of them: "`key` is one of ...". */
void deck_suggest(diagnostics *d, const char *name, const char *const *names, int count,
                  const char *intro);
/* Text as messages show it: cut when long. */
const char *deck_shown(arena *a, const char *text);

#endif
