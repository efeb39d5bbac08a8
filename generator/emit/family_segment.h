/* What segments of families have in common, whatever the form of their loop: which nodes they
   compute, how a value is added or kept, and whether it matters that the bond is there.

       sum(V_j*stretch)     slot = present ? pl_fma(V_j, stretch, slot) : slot
       max(stretch)         slot = present ? pl_max(slot, stretch) : slot
       field D              new_field = present ? D : 0.0 */
#ifndef PERILAT_GENERATOR_FAMILY_SEGMENT_H
#define PERILAT_GENERATOR_FAMILY_SEGMENT_H

#include "generator/target/expression.h"

/* Some value of the segment is another one where the bond is absent. */
bool family_segment_asks(const segment *a);
bool family_root_is_reduction(const segment_root *r);
/* What a sum, a largest or smallest value begins with. */
const char *family_reduction_start(const emitter *e, const segment_root *r);
/* `to = value;`, or what becomes of `to` where it is a reduction. An array is written in any case;
   a register may stay. */
void family_store(emitter *e, const segment_root *r, const char *to, bool in_register);

/* That all is as expected, as one condition, since gcc does not vectorise two; NULL where nothing
   is expected of what is needed. */
const char *family_expected(const emitter *e);
/* From here on to family_widen lines are those that these nodes (IR_NONE: none) need; of choices by
   what is relied on only what is chosen then. Returns what was needed before. */
unsigned char *family_narrow(emitter *e, const ir_node *nodes, int count, unsigned relies);
void family_widen(emitter *e, unsigned char *before);

#endif
