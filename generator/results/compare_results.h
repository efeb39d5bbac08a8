/* Where two results differ most, history by history and field by field. A difference is relative
   to the largest absolute value that the quantity has in either result; energies are relative to
   the largest energy of all, since the smaller terms are differences of larger ones. */
#ifndef PERILAT_GENERATOR_COMPARE_RESULTS_H
#define PERILAT_GENERATOR_COMPARE_RESULTS_H

#include "dsl/base/json.h"

typedef struct results_request {
  const char *results[2];
  double tolerance;
  const char **histories, **fields; /* the only ones to look at; none given: all */
  int history_count, field_count;
} results_request;

/* Prints it, and adds each quantity to the list of a document where there is one. Exit status: 0
   the same within the tolerance; 2 different; 1 after messages. */
int compare_results(const results_request *q, json *list);

#endif
