/* Calls of built-in functions and of the law's own. */
#ifndef PERILAT_DSL_CALLS_H
#define PERILAT_DSL_CALLS_H

#include "dsl/semantics/checker.h"

value check_call(checker *ck, expr *e);
value check_function_body(checker *ck, entry *function);

#endif
