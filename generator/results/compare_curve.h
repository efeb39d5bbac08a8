/* perilat compare of a result with a table: one history over another against measured points, or a
   band. */
#ifndef PERILAT_GENERATOR_COMPARE_CURVE_H
#define PERILAT_GENERATOR_COMPARE_CURVE_H

#include "dsl/base/json.h"

typedef struct curve_request {
  const char *result, *table; /* the table perhaps with columns, "lab.csv:cmod,load" */
  const char *x, *y;          /* histories; NULL: time, load */
  const char *band;           /* two columns; NULL: the points count */
  double tolerance;
} curve_request;

/* Prints it, and adds it to the list `list` of a document where there is one. Exit status: 0
   nowhere farther than the tolerance, times the largest value of the table; 2 farther; 1 after
   messages. */
int compare_curve(const curve_request *q, json *list);

#endif
