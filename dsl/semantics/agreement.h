/* Unit, shape and place of values: when two agree, and how they are called in messages. */
#ifndef PERILAT_DSL_AGREEMENT_H
#define PERILAT_DSL_AGREEMENT_H

#include "dsl/semantics/checker.h"

extern const value BROKEN;

value scalar_of(dimension dim, placement where);

/* Where what is made of values at `a` and `b` lives. */
placement place_join(const checker *ck, placement a, placement b);
/* `v`, where what is made of it and `other` lives. */
value joined(const checker *ck, value v, value other);

/* The common unit and shape of two values; complains as "..., so they cannot be `deed`". */
value agree(checker *ck, span where, expr *a, value va, expr *b, value vb, const char *deed);
/* Complains unless the value has this unit and shape; `what` says whose, e.g. "`force N`". */
bool expect(checker *ck, expr *e, value v, dimension dim, shape s, const char *what);
bool expect_scalar(checker *ck, expr *e, value v, const char *what);

/* To a rate that has the unit of its state: that it lacks a time, and perhaps which parameter. */
void hint_rate(checker *ck, const expr *rate);

const char *describe(checker *ck, dimension dim); /* "a stress (Pa)" */
const char *shape_words(shape s);                 /* "a tensor" */
/* The written text of an expression in quotes when it is short, otherwise `otherwise`. */
const char *quoted(checker *ck, const expr *e, const char *otherwise);

#endif
