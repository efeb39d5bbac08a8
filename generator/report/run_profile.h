/* --profile: where the time of a run went. */
#ifndef PERILAT_GENERATOR_RUN_PROFILE_H
#define PERILAT_GENERATOR_RUN_PROFILE_H

#include "generator/report/run_state.h"

/* --profile: where the time of the march went, what a particle's step costs, and what limits it.
   Takes half a second. */
void print_profile(const run *r, double seconds, long steps);

#endif
