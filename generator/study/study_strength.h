/* How strong is a body? Loads are held, from small to large, and each is borne or not. The strength
   is the largest of an unbroken sequence that is borne; verdicts need not be monotonic beyond. */
#ifndef PERILAT_GENERATOR_STUDY_STRENGTH_H
#define PERILAT_GENERATOR_STUDY_STRENGTH_H

#include "dsl/base/json.h"
#include "generator/study/study_pool.h"

/* Scans r->strength, tells it and puts `lower`, `upper`, `unit`, `peak` and `cases` into the
   document. Exit status 0 when both ends stand, 2 when nothing collapsed or was borne. */
int study_strength(study_request *r, study_pool *pool, json *w);

#endif
