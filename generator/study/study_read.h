/* The table of a study, read again from its file, with the curves of its cases. */
#ifndef PERILAT_GENERATOR_STUDY_READ_H
#define PERILAT_GENERATOR_STUDY_READ_H

#include "generator/study/study_table.h"

typedef struct study_curve {
  const char *name;           /* of the case */
  const double *time, *x, *y; /* [count] SI; count 0: the case has no result */
  const char *x_unit, *y_unit;
  long count;
} study_curve;

typedef struct study_reading {
  study_table table;           /* columns that people are shown first, then the others by name */
  const char *x_name, *y_name; /* of the curves; "" where there are none */
  const study_curve *curves;   /* [curve_count] one for each row */
  int curve_count;
} study_reading;

/* Whether the file is one that can be read. */
bool study_is_table(const char *path);
/* False after a message. */
bool study_read(arena *a, const char *path, study_reading *r);
/* NULL: there is none of that name. */
const study_column *study_reading_column(const study_reading *r, const char *name);

#endif
