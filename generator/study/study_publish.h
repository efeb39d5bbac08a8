/* What a study leaves: table, picture, document. */
#ifndef PERILAT_GENERATOR_STUDY_PUBLISH_H
#define PERILAT_GENERATOR_STUDY_PUBLISH_H

#include "generator/study/study_table.h"
#include "runtime/plot/plot_curve.h"

/* A study that is done. */
typedef struct study_outcome {
  study_request *request;
  const char *const *keys; /* [key_count] varied, as columns are named */
  int key_count;
  study_case *cases;
  study_row *rows; /* [count] */
  int count;
  const char *x, *y; /* of the picture; NULL: the usual ones */
  const bool *drawn; /* [count] and printed; NULL: all */
  double y_most;     /* of the picture; 0: all that there is */
  const plot_beside *beside;
  int beside_count;
  const study_column *more; /* [more_count] of the table, behind the others */
  int more_count;
} study_outcome;

/* Fills the rows from the results. False after a message. */
bool study_read_rows(study_outcome *o);
/* Writes NAME.csv, NAME.h5 and NAME.png, prints the table, says where all is. False after a
   message. */
bool study_publish(const study_outcome *o, json *w);
/* Rows with a result; those of runs that went well. */
int study_rows_there(const study_outcome *o);
int study_rows_good(const study_outcome *o);

#endif
