/* The keys of a load that say how its value develops in time. */
#ifndef PERILAT_RUNTIME_DECK_LOAD_H
#define PERILAT_RUNTIME_DECK_LOAD_H

#include "runtime/deck_value.h"

/* Reads `key` (the full value, in `unit`) and the group's history, start, rise, times and values.
   False after messages. */
bool deck_load_read(arena *a, const namelist_group *g, const namelist_key *key, const char *unit,
                    time_function *f, diagnostics *d);

/* The same without the value: how a factor develops from 0 to 1. */
bool deck_factor_read(arena *a, const namelist_group *g, time_function *f, diagnostics *d);

#endif
