/* What a study varies: "lattice.spacing = 20, 10, 5 mm with material.S_t = 1e-4, 1.2e-4, 1.5e-4" is
   an axis of three points and two keys that change together. Values are separated by commas, or,
   where they have commas themselves, by semicolons; "40..60:5 kN" counts up, or down. A unit behind
   the last number is that of those before it that have none.

   The room: many runs of one deck: cases, their processes, table and picture; strength,
   convergence, parameters from curves. */
#ifndef PERILAT_GENERATOR_STUDY_AXIS_H
#define PERILAT_GENERATOR_STUDY_AXIS_H

#include "dsl/base/arena.h"
#include "dsl/base/diagnostics.h"

enum { STUDY_MOST_VALUES = 10000 };

/* A text that was given, and where its first byte stands. */
typedef struct study_text {
  const char *text;
  span where;
} study_text;

typedef struct study_key {
  const char *name;    /* as --set takes it: "material[concrete].E" */
  const char *shown;   /* the key alone: "E" */
  const char **values; /* [count of the axis] as --set takes them: "10 mm" */
  span *places;        /* [count] where each stands; of a range its text */
  span where;          /* of the name */
} study_key;

typedef struct study_axis {
  study_key *keys;
  int key_count;
  int count; /* of points */
  span where;
} study_axis;

/* False after messages. */
bool study_axis_read(arena *a, const study_text *given, study_axis *axis, diagnostics *d);

/* Given in full, or by its last part, whatever the case. */
bool study_key_is(const study_key *key, const char *given);

/* "material.E" and "Material[1].e" are one. */
bool study_same_key(const char *a, const char *b);

/* A range "group.key = low..high" and its step; the values in SI where they are read as numbers by
   `study_number`. Without a step *step is NULL. *high NULL: the key alone, or one value. */
typedef struct study_range {
  study_key key;          /* without values */
  const char *low, *high; /* "40 kN/m" */
  const char *step;       /* of the same unit */
} study_range;
bool study_range_read(arena *a, const study_text *given, study_range *range, diagnostics *d);

/* "12.5 mm" is 12.5 and "mm". False when the text does not begin with a number. */
bool study_split_number(const char *text, double *number, const char **unit_text);
/* "12.5 mm" of 12.5 and "mm"; "12.5" without a unit. */
const char *study_value_text(arena *a, double number, const char *unit_text);

#endif
