#include "generator/grade/grade.h"

#include <stdio.h>

#include "generator/grade/answers_found.h"
#include "generator/grade/grading.h"
#include "generator/grade/mark_text.h"
#include "generator/grade/self_test.h"

enum { FULL = 0, WRONG = 1, LESS = 2 };

static int grade_all(grading *g) {
  int count, status = FULL;
  handed_in *answers = answers_found(g->memory, g->e, g->o->answer, &count);
  if (count < 0) return WRONG;
  for (int k = 0; k < count; k++) {
    marks m;
    if (!grading_judge(g, &answers[k], &m)) status = WRONG;
    if (k) putchar('\n');
    marks_print(g->e, &m, stdout);
    if (status != WRONG && !marks_are_full(g->e, &m)) status = LESS;
    marks_close(&m);
  }
  return status;
}

int grade(const grade_options *o) {
  grading g;
  int status = WRONG;
  if (grading_open(&g, o)) status = o->self_test ? self_test(&g) ? FULL : WRONG : grade_all(&g);
  grading_close(&g);
  return status;
}
