/* What loops over a strip of bonds read and write: arrays of pl_strip, and what absent bonds leave
   behind. */
#ifndef PERILAT_GENERATOR_STRIP_ARRAYS_H
#define PERILAT_GENERATOR_STRIP_ARRAYS_H

#include "generator/target/expression.h"

extern const scope scope_of_strips;

/* The array that a root is written to, by the name that it has in the function. */
const char *strip_array(const emitter *e, const segment_root *r);
/* Names the array before the loop, as what `value` is. */
void strip_declare_array(emitter *e, const segment_root *r, const char *value);
/* Arrays of the fields that are read, of all or of those only that the pass does not write. */
void strip_declare_fields(emitter *e, bool only_read);
/* Those, and all that the pass writes. */
void strip_declare_outputs(emitter *e);
void strip_declare_protection(emitter *e);
/* Absent bonds are evaluated too (no branch), and what they gave is dropped here, unless their line
   has been 0 before. */
void strip_store(emitter *e, const segment_root *r);

#endif
