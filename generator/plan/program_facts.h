/* What the runtime and the writers of a program ask of it once it is made. */
#ifndef PERILAT_GENERATOR_PROGRAM_FACTS_H
#define PERILAT_GENERATOR_PROGRAM_FACTS_H

#include "dsl/base/arena.h"
#include "generator/plan/segment.h"

/* pl_program.at_hand */
unsigned program_at_hand(const ir *g, const kernel_program *p);
/* pl_program.upward, spared */
unsigned program_upward(const ir *g, const kernel_program *p);
int program_reaches_spared(const ir *g, const kernel_program *p);
/* pl_program.shared of a pass */
uint64_t program_shared_by(const program_pass *p);

/* Whether bonds of the pass add to both ends. */
bool program_is_paired(const program_pass *p);
/* Whether the program writes the field, which stands toward neighbours, bond by bond at both
   ends. */
bool program_pairs_field(const kernel_program *p, int field);
/* The root that leaves what is read from a source and index (a link, or what ends share): of the
   last pass before *pass, which becomes that of the root; NULL: none. */
segment_root *program_writer(const kernel_program *p, ir_source from, int index, int *pass);

/* How many sums of what is the same for all bonds of a class (segment_is_constant) the program has,
   or has before that segment's. */
int program_constant_sums(const ir *g, const kernel_program *p, const segment *before);
/* Which segment of pairs finds out where bonds are as is expected (ir_expect), for all that come
   later; NULL: none. Later segments may expect only what it has asked of the motion. */
const segment *program_asks(const ir *g, const kernel_program *p);
bool program_is_told(const ir *g, const kernel_program *p, const segment *a);
/* The passes of one program, then those of another that has been built after it. */
kernel_program program_joined(arena *memory, const char *name, const kernel_program *first,
                              const kernel_program *then);
/* Sums that one pass adds to far ends, the most. */
int program_sum_count(const kernel_program *p);

#endif
