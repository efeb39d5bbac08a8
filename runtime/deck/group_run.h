/* Groups of the run as a whole: how long, dynamic or quasi-static, what it writes and how often;
   and of many runs. */
#ifndef PERILAT_RUNTIME_GROUP_RUN_H
#define PERILAT_RUNTIME_GROUP_RUN_H

#include "runtime/deck/deck_schema.h"

extern const deck_group_info deck_group_simulation, deck_group_relaxation, deck_group_static,
    deck_group_start, deck_group_output, deck_group_checkpoint, deck_group_study;

/* Of a run that ends at `end`, s; false after a message. */
bool deck_samples_fit(const deck_output *item, double end, diagnostics *d);

#endif
