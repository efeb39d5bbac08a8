/* How a run ended, for other programs: run --json. */
#ifndef PERILAT_GENERATOR_RUN_DOCUMENT_H
#define PERILAT_GENERATOR_RUN_DOCUMENT_H

#include "dsl/base/json.h"
#include "generator/report/run_state.h"

/* How the run ended, as entries of the open object. */
void put_run(json *w, const run *r);

#endif
