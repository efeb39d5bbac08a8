/* The segments of a pass: in which loop each value is computed, and what is kept between loops. */
#ifndef PERILAT_GENERATOR_PROGRAM_SCHEDULE_H
#define PERILAT_GENERATOR_PROGRAM_SCHEDULE_H

#include "generator/plan/program_builder.h"

/* Makes the segments of a pass that computes `roots`. parity: of sums over the family, what the other end adds up, plus 1
   (program_parity_of_root). With `pairs` a loop that both ends of a bond would do alike is done bond by bond. */
void program_schedule(ir *g, arena *memory, family_pass *pass, const segment_root *roots,
                      int root_count, const node_map *parity, bool pairs);

#endif
