/* The shapes of a deck's modes as a result: each mode is a frame. */
#ifndef PERILAT_GENERATOR_RUN_SHAPES_H
#define PERILAT_GENERATOR_RUN_SHAPES_H

#include "generator/report/run_state.h"
#include "runtime/simulation/modes.h"

/* Displacements, and rotations where particles turn, the largest displacement, or rotation times
   spacing, 1 % of the longest side of what there is; numbers from 1 in place of times, and the
   history `frequency`. False after a message: nothing is written. */
bool write_shapes(run *r, const mode *modes, int count);

#endif
