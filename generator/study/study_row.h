/* What a case has come to, as its result tells: the curve y(x) and its peak, the other monitors, the
   energies at the end. */
#ifndef PERILAT_GENERATOR_STUDY_ROW_H
#define PERILAT_GENERATOR_STUDY_ROW_H

#include "generator/study/study_case.h"

typedef struct study_history {
  const char *name, *unit;
  double peak, peak_time, last; /* the peak is the largest in size, with its sign */
} study_history;

typedef struct study_row {
  const study_case *of;
  bool there;               /* a result was read; without one all below is NaN, 0 or NULL */
  const char *ended;        /* in words; without a result why there is none */
  double steps, step, wall; /* step and wall in s */
  const study_history
      *histories; /* [history_count] in alphabetical order; energies are among them */
  int history_count;
  const char *x_name, *y_name; /* the full names of those that were asked for */
  const char *x_unit, *y_unit;
  const double *time, *x, *y; /* [count] */
  long count;
  double peak, at; /* of y, and the x there */
} study_row;

/* x NULL: time; y NULL: load, or else the first monitor. False after a message: the result is there,
   but has no such history. */
bool study_row_read(arena *a, const study_case *c, const char *x, const char *y, study_row *row);
/* NULL: the row has none of that name. */
const study_history *study_row_history(const study_row *row, const char *name);

#endif
