/* The table of a study: a row for each case, columns of texts or of numbers in one unit. */
#ifndef PERILAT_GENERATOR_STUDY_TABLE_H
#define PERILAT_GENERATOR_STUDY_TABLE_H

#include "dsl/base/json.h"
#include "generator/study/study_row.h"

typedef struct study_column {
  const char *name, *unit; /* unit NULL: texts */
  const char **texts;      /* [rows] */
  double *values;          /* [rows] in SI, or of a varied key in the unit that it was given in */
  bool shown;              /* when the table is printed */
  int place;               /* of a table that is read: where it is shown */
} study_column;

typedef struct study_table {
  study_column *columns;
  int column_count, rows;
} study_table;

/* `keys` are the varied ones, of which each case has a value. */
study_table study_table_of(arena *a, const study_row *rows, int count, const char *const *keys,
                           int key_count);
void study_table_add(arena *a, study_table *t, const study_column *c);
/* Prints the columns that people look at, of all rows, or of those that are `wanted`. */
void study_table_print(const study_table *t, const bool *wanted, FILE *out);
/* Comma-separated values, which appear whole or not at all. False after a message. */
bool study_table_csv(const study_table *t, const char *path);
/* The same as /table/NAME, with the curves as /cases/NAME/{x, y, time}. */
bool study_table_hdf5(const study_table *t, const study_row *rows, const char *path);
/* The columns with their units, and a list of objects, one a row. */
void study_table_json(const study_table *t, const char *list, json *w);

#endif
