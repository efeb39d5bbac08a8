/* Plan to C: one self-contained source text (elementary functions and kernel.h are written into it), one function a
   pass, the model's own names, the source line in a comment. Loops are branch-free and unit-stride on rows. */
#ifndef PERILAT_GENERATOR_EMIT_H
#define PERILAT_GENERATOR_EMIT_H

#include "generator/plan/passes.h"

/* malloc'ed text; the same plan gives the same text. The key in its descriptor is empty. No text of the law reaches C other
   than checked identifiers and numbers; descriptions are written as escaped string literals. */
char *emit_kernel(const kernel_plan *p);
/* Such a text with a key in its descriptor, the toolchain_key of that text; malloc'ed. */
char *emit_keyed(const char *unkeyed, const char *key);

/* How the loop of a pass over strips is cut into stages (stages.h), and what that is estimated to cost: for
   --dump=passes. Nothing for other passes. */
void emit_describe_loops(const kernel_plan *p, pass_kind kind, FILE *out);

#endif
