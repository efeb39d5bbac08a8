/* The lowest modes of a deck's bodies, told as a table, or in the document; their shapes as a
   result where the options ask for it. */
#ifndef PERILAT_GENERATOR_RUN_MODES_H
#define PERILAT_GENERATOR_RUN_MODES_H

#include "generator/report/run_state.h"

/* As many as the options ask for, of a simulation that has not begun. Returns the exit status. */
int tell_modes(run *r);

#endif
