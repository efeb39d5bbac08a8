/* An answer judged in a process of its own, in an empty folder of its own that is gone afterwards. */
#ifndef PERILAT_GENERATOR_GRADE_CHILD_H
#define PERILAT_GENERATOR_GRADE_CHILD_H

#include "generator/grade/confine.h"
#include "generator/grade/judge.h"

/* An answer as it was handed in. */
typedef struct handed_in {
  const char *name;   /* of the student, or of the file */
  const char *file;   /* NULL: there is none */
  const char *folder; /* its further laws may be included; NULL: none may */
} handed_in;

/* Fills `m`, which is open. What can not be judged to the end is told in m->trouble; it is never an
   error of the grader. q->answer is set here. False only where no process can be started, after a
   sentence. */
bool grade_in_child(marks *m, const judge_request *q, const handed_in *answer,
                    const confinement *to);

#endif
