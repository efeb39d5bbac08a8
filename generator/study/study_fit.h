/* Which parameters make computed curves follow measured ones, and how well the data tell them: the
   runs of a search (fit_search.h, fit_uncertainty.h) as cases of a study, so that they are done
   once, whatever stops it. Each point of the search is a run of every deck. */
#ifndef PERILAT_GENERATOR_STUDY_FIT_H
#define PERILAT_GENERATOR_STUDY_FIT_H

#include "dsl/base/json.h"
#include "generator/study/study_pool.h"

/* Fits r->fit to r->to, tells it and puts `parameters`, `correlation`, `rms`, `runs` and `cases`
   into the document. Exit status 0 when the data tell all parameters, 2 when not. */
int study_fit(study_request *r, study_pool *pool, json *w);

#endif
