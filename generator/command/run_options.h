/* Options of `perilat run`, `perilat check` and of solvers, and a run as they ask for it. */
#ifndef PERILAT_GENERATOR_RUN_OPTIONS_H
#define PERILAT_GENERATOR_RUN_OPTIONS_H

#include "generator/run/run.h"

/* Who reads options. A solver has its kernel built in: there is nothing to interpret or compare. */
typedef enum option_reader { OF_RUN, OF_CHECK, OF_SOLVER } option_reader;

/* What only `perilat check` is asked. */
typedef struct check_options {
  const char *dump, *diagnostics; /* NULL where not given */
} check_options;

/* False after a message. `check` is for OF_CHECK. o->overrides is to be freed. */
bool read_run_options(option_reader reader, const char *program, int argc, char **argv,
                      run_options *o, check_options *check);

/* The run, and with --json its document; nothing where it is not `runnable` (NULL: it is). */
int run_as_asked(run_options *o, bool (*runnable)(const run_options *o));

#endif
