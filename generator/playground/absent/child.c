/* A process for each answer: a page judges its own answer itself. It is fenced in by the
   browser. */
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include "generator/grade/grade_child.h"
#include "generator/grade/judge_table.h"
#include "generator/kernel/document.h"

/* What runs print on their way is nobody's: standard output and error lead nowhere. */
static void quiet_begin(int kept[2]) {
  fflush(NULL);
  const int nowhere = open("/dev/null", O_WRONLY);
  for (int k = 0; k < 2; k++) {
    kept[k] = dup(k + 1);
    dup2(nowhere, k + 1);
  }
  close(nowhere);
}

static void quiet_end(const int kept[2]) {
  fflush(NULL);
  for (int k = 0; k < 2; k++) {
    dup2(kept[k], k + 1);
    close(kept[k]);
  }
}

bool grade_child_begin(judging_child *c, marks *m, const judge_request *q, const handed_in *answer,
                       const handed_text *text, const confinement *to) {
  judge_request here = *q;
  char *said;
  size_t size;
  int kept[2];
  (void)c, (void)to;
  m->trouble = text->bad;
  if (m->trouble) return true;
  here.answer = here.shown = answer->file;
  FILE *out = must_open_text(&said, &size);
  quiet_begin(kept);
  if (q->basis->of->of_answers)
    judge_table(&here, out);
  else
    judge_answer(&here, out);
  quiet_end(kept);
  must_close_text(out);
  records_read(m, said, size);
  if (!m->ended) m->trouble = "it could not be judged to the end";
  free(said);
  return true;
}

void grade_child_end(judging_child *c, const confinement *to) {
  (void)c, (void)to;
}
