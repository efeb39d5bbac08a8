#include "generator/grade/grading.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/hash.h"
#include "generator/exercise/path_sample.h"
#include "generator/kernel/document.h"

/* --- one answer ------------------------------------------------------------------------------- */

static uint64_t seed_of(const grading *g, const exercise_item *item, const handed_text *text) {
  uint64_t seed = item->seed;
  if (item->seed_of_student) seed = handed_text_seed(text);
  return g->o->seeded ? hash_more(seed, &g->o->seed, sizeof g->o->seed) : seed;
}

/* Random paths of all sample items, one after the other. False after messages. */
static bool draw_samples(grading *g, arena *a, const handed_text *text, judge_request *q) {
  const exercise *e = g->e;
  q->samples = NULL;
  for (int k = 0; k < e->item_count; k++) {
    const exercise_item *item = &e->items[k];
    int known, count;
    if (item->kind != ITEM_SAMPLE || !item_is_judged(item, g->o->only_public)) continue;
    const path_case *origins = sample_origins(&g->basis, item, &known);
    path_case *more = path_samples(a, item, origins, known, e->solution, &g->basis.kept,
                                   seed_of(g, item, text), &count, &g->basis.said);
    if (!more) return false;
    path_case *all = arena_alloc(a, (size_t)(q->sample_count + count + 1) * sizeof *all);
    if (q->sample_count) memcpy(all, q->samples, (size_t)q->sample_count * sizeof *all);
    memcpy(all + q->sample_count, more, (size_t)count * sizeof *all);
    q->samples = all;
    q->sample_count += count;
  }
  return true;
}

static const marks *judged_like(const grading *g, const char *bare) {
  for (int k = 0; k < g->judged_count && bare; k++)
    if (strcmp(g->judged[k].bare, bare) == 0) return g->judged[k].m;
  return NULL;
}

void grading_keep(grading *g, const judging_child *c) {
  if (!c->bare || !c->m->ended || judged_like(g, c->bare)) return;
  g->judged = arena_room(g->memory, g->judged, g->judged_count, sizeof *g->judged);
  g->judged[g->judged_count++] = (judged_law){c->bare, c->m};
}

bool grading_begin(grading *g, const handed_in *answer, marks *m, judging_child *c) {
  arena *a = arena_new();
  judge_request q = {.basis = &g->basis, .only_public = g->o->only_public};
  marks_open(m, answer->name, g->e->item_count);
  *c = (judging_child){.m = m, .from = -1};
  const handed_text text = handed_answer_read(a, answer->file);
  c->bare = text.bad ? NULL : handed_text_bare(g->memory, &text);
  q.like = judged_like(g, c->bare);
  const bool good = (text.bad || draw_samples(g, a, &text, &q)) &&
                    grade_child_begin(c, m, &q, answer, &text, &g->o->limits);
  for (int k = 0; k < q.sample_count; k++)
    path_case_close(&q.samples[k]); /* the process has them */
  arena_free(a);
  return good;
}

void grading_end(grading *g, judging_child *c) {
  grade_child_end(c, &g->o->limits);
}

bool grading_judge(grading *g, const handed_in *answer, marks *m) {
  judging_child c;
  const bool good = grading_begin(g, answer, m, &c);
  grading_end(g, &c);
  return good;
}

/* What the solution implies and what its runs give, where no value is expected. False after a
   message. */
static bool measure_solution(grading *g) {
  const exercise *e = g->e;
  bool needed = false;
  marks m;
  for (int k = 0; k < e->item_count; k++)
    needed = needed || (item_is_judged(&e->items[k], g->o->only_public) && !e->items[k].value &&
                        !e->items[k].like_count &&
                        (e->items[k].kind == ITEM_IMPLIED || e->items[k].kind == ITEM_RUN));
  if (!needed || !e->solution) return true;
  const handed_in solution = {"the solution", e->solution, NULL};
  bool good = grading_judge(g, &solution, &m);
  for (int k = 0; k < e->item_count; k++)
    g->basis.measured[k] = m.items[k].value;
  if (m.trouble) {
    say_error("the solution of `%s` can not be judged: %s", e->given, m.trouble);
    good = false;
  }
  marks_close(&m);
  return good;
}

/* --- the whole -------------------------------------------------------------------------------- */

bool grading_open(grading *g, const grade_options *o) {
  *g = (grading){.o = o, .memory = arena_new()};
  diag_begin(&g->said, &g->sources);
  g->e = exercise_read(g->memory, &g->sources, o->exercise, &g->said);
  if (!g->e) return false;
  g->opened = true;
  return grade_basis_open(&g->basis, g->e, o->only_public) && measure_solution(g);
}

void grading_close(grading *g) {
  fflush(stdout);
  diag_print(&g->said, stderr);
  if (g->opened) {
    diag_print(&g->basis.said, stderr);
    grade_basis_close(&g->basis);
  }
  diag_clear(&g->said);
  source_clear(&g->sources);
  arena_free(g->memory);
}
