/* Plan to C: one self-contained source text (elementary functions and kernel.h are written into
   it), one function a pass, the model's own names, the source line in a comment. Loops are
   branch-free and unit-stride on rows. */
#ifndef PERILAT_GENERATOR_EMIT_H
#define PERILAT_GENERATOR_EMIT_H

#include "generator/plan/passes.h"

/* malloc'ed text; the same plan and key give the same text. `key` goes into the descriptor; it is
   the toolchain_key of the text emitted with the key "". No text of the law reaches C other than
   checked identifiers and numbers; descriptions are written as escaped string literals. */
char *emit_kernel(const kernel_plan *p, const char *key);

#endif
