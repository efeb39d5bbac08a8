/* Nodes of the tree with their spans, as the grammar makes them; checks depth and index. */
#ifndef PERILAT_DSL_TREE_BUILD_H
#define PERILAT_DSL_TREE_BUILD_H

#include "dsl/syntax/parsing.h"

expr *build_number(parsing *p, double number, word written_unit, span where);
/* `?`, maybe with a unit (.text NULL without). */
expr *build_hole(parsing *p, word written_unit, span where);
expr *build_name(parsing *p, word name, bool primed, word index, span where);
/* x, x[j], or the component v[x] of a vector. */
expr *build_name_or_axis(parsing *p, word name, word index, span where);
/* v[j][x] */
expr *build_axis(parsing *p, expr *vector, word axis, span where);
/* sigma[x,y]: `first` and `second` name axes. */
expr *build_component(parsing *p, expr *tensor, word first, word second, span where);
/* (x, y, z), or (x, y): `z` is NULL. */
expr *build_vector(parsing *p, expr *x, expr *y, expr *z, span where);
expr *build_unary(parsing *p, unary_op op, expr *operand, span where);
expr *build_binary(parsing *p, binary_op op, expr *left, expr *right, span where);
expr *build_call(parsing *p, word name);
expr *build_argument(parsing *p, expr *call, word keyword, expr *value);
expr *build_cases(parsing *p, span where);
expr *build_case(parsing *p, expr *cases, expr *value, expr *guard, bool jump, span where);
/* A line `| ?` of cases. */
expr *build_open_case(parsing *p, expr *cases, span where);
words *build_words(parsing *p);
words *build_word(parsing *p, words *list, word item);
bounds build_bounds(parsing *p, bool lower_open, expr *lower, expr *upper, bool upper_open,
                    span where);
/* index.text is NULL for a name without [j]. */
stmt *build_stmt(parsing *p, stmt_kind kind, word name, word index, expr *value, span where);
void build_placement(parsing *p, stmt *s, word on);
/* A state that begins at `tensor 0`, `deviator 0` or `vector 0`; `tensor` is the word that stands
   there. */
void build_tensor_state(parsing *p, stmt *s, word tensor);
/* What a law of cracks gives: `grow`, `toward`, `speed`, which are their names, too. */
stmt *build_tip_stmt(parsing *p, stmt_kind kind, span name_where, expr *value, span where);
/* `failed when ...`: a damage of the point called `failed`, 0 or 1. */
stmt *build_failure(parsing *p, span name_where, expr *guard, span where);
/* `rest stretch = ...`: the definition of `rest_stretch`. */
stmt *build_rest(parsing *p, word of, word index, expr *value, span where);
/* Behind it: `total_stretch = stretch + rest_stretch`. */
stmt *build_total(parsing *p, const stmt *rest);
void build_words_of(stmt *s, const words *list);
void build_force_state(parsing *p, word state, stmt *s, word direction);

#endif
