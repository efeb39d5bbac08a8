#include "generator/grade/self_test.h"

#include <stdio.h>

#include "dsl/base/characters.h"
#include "generator/grade/mark_text.h"

static void print_verdict(bool good, const char *name) {
  printf("%s  %s: ", good ? "ok  " : "FAIL", name_shown(name));
}

/* All points; of the solution `all_cases` are reached. */
static bool test_right(grading *g, const char *name, const char *path, bool all_cases) {
  marks m;
  const handed_in answer = {name, path, NULL};
  bool good = grading_judge(g, &answer, &m);
  const mark_sums s = marks_add_up(g->e, &m);
  good = good && marks_are_full(g->e, &m);
  const bool whole = !all_cases || m.reached == m.cases;
  print_verdict(good && whole, name);
  printf("%s of %d points", points_shown(s.got), s.judged);
  if (m.cases) printf(", %d of %d conditions seen true and false", m.reached, m.cases);
  putchar('\n');
  for (int k = 0; !whole && k < m.notes.count; k++)
    printf("      %s\n", m.notes.items[k]);
  if (!good) marks_print(g->e, &m, stdout);
  good = good && whole;
  marks_close(&m);
  return good;
}

/* Less than all, and its own sentence. */
static bool test_wrong(grading *g, int wrong) {
  const known_answer *known = &g->e->wrong[wrong];
  marks m;
  const handed_in answer = {known->name, known->path, NULL};
  bool good = grading_judge(g, &answer, &m);
  const mark_sums s = marks_add_up(g->e, &m);
  const bool less = !marks_are_full(g->e, &m);
  good = good && less && m.known == wrong;
  print_verdict(good, known->name);
  if (!less)
    puts("it gets all points: no path tells it from the solution");
  else if (m.known < 0)
    printf("%s of %d points, but its sentence is not said%s%s\n", points_shown(s.got), s.judged,
           m.trouble ? ": " : "", m.trouble ? m.trouble : "");
  else if (m.known != wrong)
    printf("it looks like %s on all paths\n", name_shown(g->e->wrong[m.known].name));
  else
    printf("%s of %d points, and its sentence\n", points_shown(s.got), s.judged);
  marks_close(&m);
  return good;
}

bool self_test(grading *g) {
  const exercise *e = g->e;
  bool good = true;
  if (e->solution) good = test_right(g, "solution", e->solution, true);
  for (int k = 0; k < e->equal_count; k++)
    good = test_right(g, e->equal[k].name, e->equal[k].path, false) && good;
  for (int k = 0; k < e->wrong_count; k++)
    good = test_wrong(g, k) && good;
  printf("%s: %d equal form%s, %d wrong answer%s: %s\n", name_shown(e->name), e->equal_count,
         e->equal_count == 1 ? "" : "s", e->wrong_count, e->wrong_count == 1 ? "" : "s",
         good ? "all hold" : "not all hold");
  return good;
}
