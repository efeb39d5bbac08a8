/* Formulas in decks: which values are formulas, what they may read, and how they are read. */
#ifndef PERILAT_RUNTIME_DECK_FORMULA_H
#define PERILAT_RUNTIME_DECK_FORMULA_H

#include "dsl/semantics/formula.h"
#include "runtime/deck/deck.h"
#include "runtime/deck/namelist.h"

/* x, y, z, t; x, y, z; t: in the order of FORMULA_X ... */
extern const formula_scope deck_formula_of_all, deck_formula_of_place, deck_formula_of_time;

/* A text that is no number with a unit, and no single word. */
bool deck_is_formula(const namelist_value *v);
/* The value of `key` as a formula in that unit (NULL: any); NULL after messages. */
const formula *deck_formula_read(arena *a, const namelist_value *v, const char *key,
                                 const formula_scope *scope, const char *unit_text, diagnostics *d);

/* A number, or a formula of x, y, z. */
bool deck_placed_read(arena *a, const namelist_key *key, const char *unit_text, deck_placed *p,
                      diagnostics *d);

#endif
