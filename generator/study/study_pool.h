/* Runs of a study, several at a time, each a process of its own: what one does wrong is no other's
   harm. A signal that stops the study stops them, each with its checkpoint; so does its death. */
#ifndef PERILAT_GENERATOR_STUDY_POOL_H
#define PERILAT_GENERATOR_STUDY_POOL_H

#include "generator/study/study_folder.h"

typedef struct study_pool {
  const study_request *request;
  study_folder *folder;
  int expected; /* runs of all batches, at most; 0: there is one batch */
  int before;   /* runs of the batches that are behind */
  double shown; /* of the bar, which never goes back */
} study_pool;

/* Runs the cases that are not done. 0; a signal's number when one stopped it; after a message the
   exit status, negative. */
int study_pool_run(study_pool *p, study_case *cases, int count);
/* How many at the same time, of that many. */
int study_pool_jobs(const study_request *r, int count);

#endif
