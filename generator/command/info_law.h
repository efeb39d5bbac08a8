/* What a law is and what it implies on a lattice, as text or JSON: `perilat info law.plm`. */
#ifndef PERILAT_GENERATOR_INFO_LAW_H
#define PERILAT_GENERATOR_INFO_LAW_H

#include <stdbool.h>

#include "dsl/base/diagnostics_json.h"

typedef struct info_law_options {
  const char *law;                 /* name or path */
  const char *spacing, *thickness; /* e.g. "6.35 mm"; NULL: 10 mm, 100 mm */
  const char *area;                /* of a chain; NULL: 100 mm^2 */
  /* kind; NULL: hexagonal, for laws of families in space fcc with second neighbours */
  const char *lattice;
  const char *horizon, *shells; /* numbers; NULL: the nearest neighbours */
  const char *const *settings;  /* "name=value" */
  int setting_count;
  diag_json *report; /* the law goes to its document, after the diagnostics; NULL: as text */
} info_law_options;

/* Exit status. */
int info_law(const info_law_options *o);

#endif
