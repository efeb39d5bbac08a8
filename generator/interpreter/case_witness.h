/* Which cases of a law were reached while it was driven on the interpreter. A condition counts
   where it is asked: one behind other cases only in states that these leave to it. */
#ifndef PERILAT_GENERATOR_CASE_WITNESS_H
#define PERILAT_GENERATOR_CASE_WITNESS_H

#include <stdbool.h>

#include "dsl/base/source.h"
#include "runtime/kernel.h"

/* A condition of a law. */
typedef struct case_seen {
  int choice; /* its number in the law's graph */
  span where; /* of what it decides */
  bool was_true, was_false;
} case_seen;

/* What several drives of one law have seen. */
typedef struct cases_seen {
  case_seen *items; /* to be freed */
  int count;
} cases_seen;

typedef struct case_witness case_witness;
/* Looks on while the kernel, which is interpreted, runs in one thread, until it is ended; what was
   seen is added to `seen`. */
case_witness *case_witness_begin(const pl_law *kernel);
void case_witness_end(case_witness *w, cases_seen *seen);

#endif
