/* Formulas for browsers: the LaTeX that laws are explained in (explain_math.h, the formulas of
   builtins.h) as MathML Core. Not for LaTeX from elsewhere: what it does not know stands as
   text. */
#ifndef PERILAT_DSL_MATHML_H
#define PERILAT_DSL_MATHML_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

/* `block`: on a line of its own. */
void mathml_put(const char *latex, size_t length, bool block, FILE *out);

C_LINKAGE_END

#endif
