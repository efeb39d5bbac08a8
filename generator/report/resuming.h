/* How a run that was stopped goes on: the command, and why a checkpoint does not fit. */
#ifndef PERILAT_GENERATOR_RESUMING_H
#define PERILAT_GENERATOR_RESUMING_H

#include "generator/report/run_state.h"

/* The command that goes on from the checkpoint. */
void print_resume(const run *r, FILE *out);
/* What the checkpoint belongs to and this run is not, when that is why it does not fit. */
void print_misfit(const run *r);

#endif
