#include "generator/grade/grade.h"

#include <stdio.h>

#include "generator/grade/answers_found.h"
#include "generator/grade/grading.h"
#include "generator/grade/mark_files.h"
#include "generator/grade/mark_page.h"
#include "generator/grade/mark_text.h"
#include "generator/grade/publish.h"
#include "generator/grade/self_test.h"
#include "generator/kernel/document.h"
#include "runtime/base/processors.h"

enum { FULL = 0, WRONG = 1, LESS = 2 };

static void show(const grading *g, const marks *m, int number) {
  if (g->o->json) return;
  if (number) putchar('\n');
  marks_print(g->e, m, stdout);
  fflush(stdout);
}

/* As many at a time as there are processors, shown in their order as they are done, so that a class
   is seen to go on; NULL where the grader fails. */
static marks *judge_all(grading *g, const handed_in *answers, int count) {
  marks *all = arena_alloc(g->memory, ((size_t)count + 1) * sizeof *all);
  judging_child *children = arena_alloc(g->memory, ((size_t)count + 1) * sizeof *children);
  const int beside = usable_processors();
  bool good = true;
  int begun = 0;
  for (int k = 0; k < begun || (good && begun < count); k++) {
    for (; good && begun < count && begun < k + beside; begun++)
      good = grading_begin(g, &answers[begun], &all[begun], &children[begun]);
    grading_end(g, &children[k]);
    grading_keep(g, &children[k]);
    if (good) show(g, &all[k], k);
  }
  return good ? all : NULL;
}

static bool write_files(const grading *g, const marks *all, int count) {
  const grade_options *o = g->o;
  bool good = true;
  if (o->csv) good = marks_csv(g->e, all, count, o->csv) && good;
  if (o->junit) good = marks_junit(g->e, all, count, o->junit) && good;
  if (o->html) good = marks_page(g->e, all, count, o->html) && good;
  return good;
}

static void put_all(const grading *g, const marks *all, int count, json *j) {
  json_put_text(j, "exercise", g->e->name);
  json_put_text(j, "title", g->e->title);
  json_put_array(j, "answers");
  for (int k = 0; k < count; k++)
    marks_json(g->e, &all[k], j);
  json_array_end(j);
}

static int grade_all(grading *g, json *j) {
  int count, status = FULL;
  handed_in *answers = answers_found(g->memory, g->e, g->o->answer, &count);
  marks *all = count < 0 ? NULL : judge_all(g, answers, count);
  if (!all) return WRONG;
  for (int k = 0; k < count; k++)
    if (!marks_are_full(g->e, &all[k])) status = LESS;
  if (j) put_all(g, all, count, j);
  if (!write_files(g, all, count)) status = WRONG;
  for (int k = 0; k < count; k++)
    marks_close(&all[k]);
  return status;
}

/* What is asked for, of an exercise that is in order. */
static int do_asked(grading *g, json *j) {
  const grade_options *o = g->o;
  if (o->publish) return publish(g->e, &g->sources, o->publish) ? FULL : WRONG;
  if (o->self_test) return self_test(g) ? FULL : WRONG;
  return grade_all(g, j);
}

int grade(const grade_options *o) {
  grading g;
  document d;
  if (o->json) document_begin(&d);
  const int status = grading_open(&g, o) ? do_asked(&g, o->json ? &d.writer : NULL) : WRONG;
  grading_close(&g);
  return o->json ? document_end(&d, status) : status;
}
