/* What a run says when a state has gone bad: where, what its bond, family or point was like, and
   what may mend it. */
#ifndef PERILAT_GENERATOR_REPORT_BAD_H
#define PERILAT_GENERATOR_REPORT_BAD_H

#include "generator/report/run_state.h"

/* Why and where, to stderr; leaves a path that drives the bond or point at fault. */
void report_bad(const run *r);

#endif
