/* A formula: one expression by itself, of variables that its reader names. It is written and checked
   as in a law, and has the values that it has there, to the bit. */
#ifndef PERILAT_DSL_FORMULA_H
#define PERILAT_DSL_FORMULA_H

#include <stdbool.h>

#include "dsl/base/arena.h"
#include "dsl/base/c_linkage.h"
#include "dsl/base/diagnostics.h"
#include "dsl/base/units.h"

C_LINKAGE_BEGIN

typedef struct formula_variable {
  const char *name, *unit; /* name "": it is not to be read here */
} formula_variable;

typedef struct formula_scope {
  const formula_variable *variables;
  int count;
  const char *words; /* the variables in messages: "x, y, z (m), t (s)" */
} formula_scope;

typedef struct formula formula;

/* The part `where` of a source. Its value is of that unit; NULL: of any. `what` says whose value it
   is: "`value`". NULL after messages. */
const formula *formula_read(arena *memory, source_set *sources, span where,
                            const formula_scope *scope, const char *unit_text, const char *what,
                            diagnostics *d);

/* Of its value; a bare 0 has none. */
dimension formula_dimension(const formula *f);
bool formula_is_zero(const formula *f);
/* Whether the value depends on the variable of that position. */
bool formula_reads(const formula *f, int variable);
/* SI; `variables` in the order of the scope. Nothing is allocated. */
double formula_value(const formula *f, const double *variables);

C_LINKAGE_END

#endif
