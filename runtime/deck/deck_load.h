/* The keys of a load that say how large it is and how it develops in time. */
#ifndef PERILAT_RUNTIME_DECK_LOAD_H
#define PERILAT_RUNTIME_DECK_LOAD_H

#include "runtime/deck/deck_value.h"

/* A way to give a load: the key of its full value, and the unit. Where the key is `implied`, values
   of a table without it are the load itself, in SI. */
typedef struct deck_load_kind {
  const char *key, *unit;
  bool implied;
} deck_load_kind;

/* Which of the kinds a load is: that whose key is written, else that whose unit its file has. -1
   after messages. */
int deck_load_kind_of(const namelist_group *g, const deck_load_kind *kinds, int count,
                      diagnostics *d);
/* Reads the full value and the group's history, start, rise, times, values and file. False after
   messages. */
bool deck_load_read(arena *a, const namelist_group *g, const deck_load_kind *kind, time_function *f,
                    diagnostics *d);

/* The same of a factor that goes from 0 to 1, on what `key` gives. */
bool deck_factor_read(arena *a, const namelist_group *g, const char *key, time_function *f,
                      diagnostics *d);

#endif
