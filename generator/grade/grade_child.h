/* An answer judged in a process of its own, in an empty folder of its own that is gone
   afterwards. */
#ifndef PERILAT_GENERATOR_GRADE_CHILD_H
#define PERILAT_GENERATOR_GRADE_CHILD_H

#include "generator/grade/confine.h"
#include "generator/grade/handed_in.h"
#include "generator/grade/judge.h"

/* A process that judges. */
typedef struct judging_child {
  marks *m;
  char folder[4096]; /* "": none was made */
  int process, from; /* from: what it says; -1: there is no process */
  double begun;
  const char *bare; /* handed_text_bare, or NULL */
} judging_child;

/* Begins to judge the text of an answer; several may run at the same time. q->answer is set here;
   request and text may go once this returns. False only where no process can be started, after a
   sentence. To be ended in any case. */
bool grade_child_begin(judging_child *c, marks *m, const judge_request *q, const handed_in *answer,
                       const handed_text *text, const confinement *to);
/* Waits for its end and fills the marks. What could not be judged to the end is told in m->trouble;
   it is never an error of the grader. */
void grade_child_end(judging_child *c, const confinement *to);

#endif
