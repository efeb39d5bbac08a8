/* The keys of a load that say how large it is and how it develops in time. */
#ifndef PERILAT_RUNTIME_DECK_LOAD_H
#define PERILAT_RUNTIME_DECK_LOAD_H

#include "runtime/deck/deck_value.h"

#define DECK_HISTORIES           "constant|ramp|ramp and hold|cosine|table|formula"
#define DECK_HISTORIES_AS_TABLES "constant|ramp|ramp and hold|cosine|table"
/* The keys themselves, for the table of a group. */
#define DECK_TIME_KEYS                                                                             \
  {.name = "history",                                                                              \
   .type = DECK_LATER,                                                                             \
   .choices = DECK_HISTORIES,                                                                      \
   .fallback = "= 'constant', in quasi-static runs a ramp over the run; 'ramp and hold' with a "   \
               "rise, 'table' with times or a file, 'formula' with one",                           \
   DECK_NOT_KEPT,                                                                                  \
   .doc = "how the value develops in time"},                                                       \
      {.name = "start",                                                                            \
       .type = DECK_LATER,                                                                         \
       .unit = "s",                                                                                \
       .fallback = "= 0",                                                                          \
       DECK_NOT_KEPT,                                                                              \
       .doc = "nothing acts before"},                                                              \
      {.name = "end",                                                                              \
       .type = DECK_LATER,                                                                         \
       .unit = "s",                                                                                \
       .fallback = "= never",                                                                      \
       DECK_NOT_KEPT,                                                                              \
       .doc = "nothing acts after: a force is 0, a drive lets go, a stamp stands"},                \
      {.name = "rise",                                                                             \
       .type = DECK_LATER,                                                                         \
       .unit = "s",                                                                                \
       DECK_NOT_KEPT,                                                                              \
       .doc = "time from `start` until the full value is reached"},                                \
      {.name = "times",                                                                            \
       .type = DECK_LATER,                                                                         \
       .unit = "s",                                                                                \
       DECK_NOT_KEPT,                                                                              \
       .doc = "table: times after `start`, ascending"},                                            \
      {.name = "values",                                                                           \
       .type = DECK_LATER,                                                                         \
       .unit = "1",                                                                                \
       DECK_NOT_KEPT,                                                                              \
       .doc = "table: factors on the value at those times, straight lines between"},               \
      {.name = "file",                                                                             \
       .type = DECK_LATER,                                                                         \
       DECK_NOT_KEPT,                                                                              \
       .doc =                                                                                      \
           "table: instead of `times` and `values`, two columns of a text file beside the deck; "  \
           "factors on the value, or with a unit and without the value the load itself"},          \
  {                                                                                                \
    .name = "formula", .type = DECK_LATER, DECK_NOT_KEPT,                                          \
    .doc = "formula: an expression; a factor on the value, or with a unit and without the value "  \
           "the load itself. It reads `t`, the time after `start`, in `&drive` and `&force` also " \
           "`x`, `y`, `z`, where a particle is at the beginning, in `&traction` those of the line" \
  }

struct formula_scope; /* dsl/semantics/formula.h */

/* A way to give a load: the key of its full value, and the unit. Where the key is `implied`, values
   of a table without it are the load itself, in SI. */
typedef struct deck_load_kind {
  const char *key, *unit;
  bool implied;
  const struct formula_scope
      *knows; /* what a formula of the load may read; NULL: it cannot be one */
} deck_load_kind;

/* Which of the kinds a load is: that whose key is written, else that whose unit its file or formula
   has. -1 after messages. */
int deck_load_kind_of(arena *a, const namelist_group *g, const deck_load_kind *kinds, int count,
                      diagnostics *d);
/* Reads the full value and the group's history, start, end, rise, times, values, file and formula.
   False after messages. */
bool deck_load_read(arena *a, const namelist_group *g, const deck_load_kind *kind, time_function *f,
                    diagnostics *d);

/* A quantity that is no load, by a table in time: the group's `times` and `values`, or the two
   columns of its `table`. `unit_of`: the unit of the values. False after messages. */
bool deck_quantity_in_time_read(arena *a, const namelist_group *g, time_function *f,
                                deck_quantity *unit_of, diagnostics *d);

/* The same of a factor that goes from 0 to 1, on what `key` gives. */
bool deck_factor_read(arena *a, const namelist_group *g, const char *key, time_function *f,
                      diagnostics *d);

#endif
