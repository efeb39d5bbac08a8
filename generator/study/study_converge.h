/* Where an answer goes as a varied value goes to 0: the rows of a study as levels of convergence.h,
   one a value of that key, the other varied keys being orientations or seeds. */
#ifndef PERILAT_GENERATOR_STUDY_CONVERGE_H
#define PERILAT_GENERATOR_STUDY_CONVERGE_H

#include "generator/study/study_publish.h"

/* Which of the varied keys it is, in their order. Its values are numbers other than 0, with units that
   are known. Negative after a message. */
int study_converge_key(study_request *r, const study_axis *axes, int axis_count);
/* Tells it, and puts `converged`, `order`, `value`, `error`, `unit` and `reason` into the document.
   Exit status: 0 it converges, 2 not. `key`: which of the outcome's keys it is. */
int study_converge(const study_outcome *o, int key, json *w);

#endif
