/* Units as they stand in a law. */
#ifndef PERILAT_DSL_LITERALS_H
#define PERILAT_DSL_LITERALS_H

#include "dsl/semantics/checker.h"

/* Reads the unit in brackets; false after a message that points at the part that is none. */
bool read_unit(checker *ck, const char *text, span where, unit *result);

#endif
