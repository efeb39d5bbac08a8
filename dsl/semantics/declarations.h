/* What each statement of a law declares. */
#ifndef PERILAT_DSL_DECLARATIONS_H
#define PERILAT_DSL_DECLARATIONS_H

#include "dsl/semantics/checker.h"

/* Enters all names of the law; duplicates and reserved names are reported. */
void declare_names(checker *ck);

#endif
