/* Formulas in decks: which values are formulas, what they may read, and how they are read. */
#ifndef PERILAT_RUNTIME_DECK_FORMULA_H
#define PERILAT_RUNTIME_DECK_FORMULA_H

#include "dsl/semantics/formula.h"
#include "runtime/deck/deck.h"
#include "runtime/base/namelist.h"

/* x, y, z, t; x, y, z; t: in the order of FORMULA_X ... */
extern const formula_scope deck_formula_of_all, deck_formula_of_place, deck_formula_of_time;

/* A text that is no number with a unit, and no single word. */
bool deck_is_formula(const namelist_value *v);
/* The value of `key` as a formula in that unit (NULL: any); NULL after messages. */
const formula *deck_formula_read(arena *a, const namelist_value *v, const char *key,
                                 const formula_scope *scope, const char *unit_text, diagnostics *d);

/* A text that names a table or a result, with or without its column: 'field.csv:E'. */
bool deck_is_place_file(const namelist_value *v);
/* Such a value: path and column. The text of a table goes with the deck, which stands in `file`. */
bool deck_place_file_read(arena *a, uint16_t file, const namelist_value *v, deck_placed *p,
                          diagnostics *d);

/* What the group's `value` or `file` says: a number, a formula of x, y, z, or places and values. */
/* Whether the value changes in time. */
bool deck_placed_changes(const deck_placed *p);
bool deck_placed_read(arena *a, const namelist_group *g, const char *unit_text, deck_placed *p,
                      diagnostics *d);

#endif
