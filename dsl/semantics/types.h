/* Gives every expression its dimension, shape and placement. Calls are in calls.c: arguments are
   expressions again, and so is the body of a function. */
#ifndef PERILAT_DSL_TYPES_H
#define PERILAT_DSL_TYPES_H

#include "dsl/semantics/agreement.h"

value check_value(checker *ck, expr *e);  /* a value, not a whole family */
value check_family(checker *ck, expr *e); /* or x without [j] */
value check_number(checker *ck, expr *e); /* neither logical */
value check_guard(checker *ck, expr *e);

#endif
