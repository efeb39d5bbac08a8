/* `perilat drive`, as far as `perilat check path.nml` needs it. */
#ifndef PERILAT_GENERATOR_COMMAND_DRIVE_H
#define PERILAT_GENERATOR_COMMAND_DRIVE_H

#include "dsl/base/diagnostics_json.h"

/* `perilat check path.nml`: everything of a drive but the driving. `report` as in run_options.
   Exit status. */
int drive_check(const char *path, const char *const *settings, int count, diag_json *report);

#endif
