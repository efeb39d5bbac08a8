/* Which quantities of bonds and lattices a law reads. */
#ifndef PERILAT_DSL_LAW_READS_H
#define PERILAT_DSL_LAW_READS_H

#include "dsl/semantics/builtins.h"
#include "dsl/semantics/law.h"

C_LINKAGE_BEGIN

/* Marks those that stand in the expression (NULL: none). */
void quantities_read(const expr *e, bool read[QUANTITY_COUNT]);

/* Does some rule read it, with the choices in force and the lattice at hand? */
bool law_reads(const law *l, builtin_quantity q);

/* Does it know by how much time goes on: by `dt`, or as a state has a rate? */
bool law_reads_time(const law *l);

/* Does some rule call it? */
bool law_calls(const law *l, builtin_function f);

C_LINKAGE_END

#endif
