/* A study from beginning to end: what is asked, the runs, and what they say. */
#ifndef PERILAT_GENERATOR_STUDY_H
#define PERILAT_GENERATOR_STUDY_H

#include "generator/study/study_pool.h"
#include "generator/study/study_table.h"

/* Runs and tells it; the document `w` gets the answer, too, where it is not NULL. Exit status: 0
   done, and the question answered; 1 the input is wrong; 2 a run has no result, or there is no
   answer; 128 + a signal that stopped it. */
int study_run(study_request *r, json *w);

#endif
