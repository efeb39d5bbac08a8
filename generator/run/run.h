/* `perilat run`: a deck and its laws to a result file, with what a person wants to be told
   before, during and after. A stand-alone solver made by `perilat build` is this same run with
   deck and kernels built in. */
#ifndef PERILAT_GENERATOR_RUN_H
#define PERILAT_GENERATOR_RUN_H

#include "dsl/base/c_linkage.h"
#include "generator/report/run_request.h"

C_LINKAGE_BEGIN

/* Returns the exit status. */
int run_deck(const run_options *o);

C_LINKAGE_END

#endif
