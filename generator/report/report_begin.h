/* What a run says before it begins: its bodies with their laws, masses and loads, times and steps,
   the machine, the result. */
#ifndef PERILAT_GENERATOR_REPORT_BEGIN_H
#define PERILAT_GENERATOR_REPORT_BEGIN_H

#include "generator/report/run_state.h"

/* What is about to be done, to stdout. */
void announce(const run *r);

#endif
