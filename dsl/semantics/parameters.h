/* Defaults and bounds of parameters, and what states begin with. */
#ifndef PERILAT_DSL_PARAMETERS_H
#define PERILAT_DSL_PARAMETERS_H

#include "dsl/semantics/checker.h"

void check_parameter(checker *ck, stmt *s);
void check_field(checker *ck, stmt *s);
void check_initial_value(checker *ck, stmt *s);
void check_bounds(checker *ck);

#endif
