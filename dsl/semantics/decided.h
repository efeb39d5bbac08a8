/* Conditions that a law's options and its lattice decide: `plane_strain`, `onset == rankine`, and
   these joined by and, or, not. */
#ifndef PERILAT_DSL_DECIDED_H
#define PERILAT_DSL_DECIDED_H

#include "dsl/semantics/law.h"

/* Is the condition made of nothing else? */
bool decided_early(const expr *condition);
/* Such a condition, with the choices in force and the lattice at hand. */
bool decided_to_hold(const law *l, const expr *condition);

#endif
