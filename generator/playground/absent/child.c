/* A process for each answer: a page judges its own answer itself. It is fenced in by the
   browser. */
#include <stdlib.h>

#include "generator/grade/grade_child.h"
#include "generator/grade/judge_table.h"
#include "generator/kernel/document.h"

bool grade_child_begin(judging_child *c, marks *m, const judge_request *q, const handed_in *answer,
                       const handed_text *text, const confinement *to) {
  judge_request here = *q;
  char *said;
  size_t size;
  (void)to;
  *c = (judging_child){.m = m, .from = -1};
  m->trouble = text->bad;
  if (m->trouble) return true;
  here.answer = here.shown = answer->file;
  FILE *out = must_open_text(&said, &size);
  if (q->basis->of->of_answers)
    judge_table(&here, out);
  else
    judge_answer(&here, out);
  must_close_text(out);
  records_read(m, said, size);
  if (!m->ended) m->trouble = "it could not be judged to the end";
  free(said);
  return true;
}

void grade_child_end(judging_child *c, const confinement *to) {
  (void)c, (void)to;
}
