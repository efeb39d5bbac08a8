/* What somebody may have meant who wrote a unit that is none. */
#ifndef PERILAT_DSL_UNIT_HINT_H
#define PERILAT_DSL_UNIT_HINT_H

#include "dsl/base/diagnostics.h"

/* Attaches a hint to the last diagnostic: "write `m^2`" for m2, "write `N*m`" for Nm, `sqrt(m)`
   for m^1/2, hours for days and K for C, "did you mean `MPa`?" for Mpa. False when nothing comes
   near the text. */
bool unit_hint(diagnostics *d, const char *text, size_t length);

#endif
