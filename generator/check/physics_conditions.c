#include "generator/check/physics_conditions.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

law_conditions conditions_new(const lowered_text *t, const ir *g, arena *memory) {
  const int count = t->line_count + t->flow_count;
  law_conditions all = {.text = t,
                        .count = count,
                        .node = arena_alloc(memory, ((size_t)count + 1) * sizeof *all.node),
                        .varies = arena_alloc(memory, (size_t)count + 1),
                        .seen = arena_alloc(memory, (size_t)count + 1),
                        .taken = arena_alloc(memory, (size_t)count + 1),
                        .shut = arena_alloc(memory, (size_t)count + 1)};
  for (int k = 0; k < count; k++) {
    all.node[k] = k < t->line_count ? t->lines[k].guard : t->flows[k - t->line_count].when;
    all.varies[k] = all.node[k] != IR_NONE && !ir_is_uniform(g, all.node[k]);
  }
  memset(all.seen, 0, (size_t)count + 1);
  memset(all.taken, 0, (size_t)count + 1);
  memset(all.shut, 0, (size_t)count + 1);
  return all;
}

/* --- lines that are taken --------------------------------------------------------------------- */

void conditions_take(law_conditions *all, double *const *holds, int lane) {
  const lowered_text *t = all->text;
  bool found = false, decided = false;
  for (int k = 0; k < t->line_count; k++) {
    if (k == 0 || t->lines[k].group != t->lines[k - 1].group) found = decided = false;
    if (decided) all->shut[k] = 1;
    if (found || holds[k][lane] == 0) continue;
    found = true;
    decided = !all->varies[k];
    all->taken[k] = 1;
  }
}

static bool are_one_line(const lowered_line *a, const lowered_line *b) {
  return a->cases == b->cases && a->line == b->line;
}

const lowered_line *conditions_never_taken(const law_conditions *all) {
  const lowered_text *t = all->text;
  for (int k = 0; k < t->line_count; k++) {
    bool taken = !all->varies[k] || all->seen[k] == 0;
    for (int q = 0; q < t->line_count && !taken; q++)
      taken = are_one_line(&t->lines[k], &t->lines[q]) && (all->taken[q] || all->shut[q]);
    if (!taken) return &t->lines[k];
  }
  return NULL;
}

/* --- counting --------------------------------------------------------------------------------- */

/* A line of the text, and how its condition was seen. */
typedef struct seen_line {
  const lowered_line *of;
  unsigned char seen;
} seen_line;

static int by_line(const void *a, const void *b) {
  const lowered_line *x = ((const seen_line *)a)->of, *y = ((const seen_line *)b)->of;
  const uintptr_t of_x = (uintptr_t)x->cases, of_y = (uintptr_t)y->cases;
  return of_x != of_y ? (of_x < of_y ? -1 : 1) : x->line - y->line;
}

static void count_one(physics_report *report, unsigned seen) {
  report->guards++;
  report->guards_reached += seen == 3;
}

void conditions_count(const law_conditions *all, physics_report *report) {
  const lowered_text *t = all->text;
  seen_line *lines = must_alloc(((size_t)t->line_count + 1) * sizeof *lines);
  int count = 0;
  for (int k = 0; k < t->line_count; k++)
    if (all->varies[k]) lines[count++] = (seen_line){&t->lines[k], all->seen[k]};
  qsort(lines, (size_t)count, sizeof *lines, by_line);
  for (int k = 0; k < count;) {
    const int first = k;
    unsigned seen = 0;
    for (; k < count && by_line(&lines[first], &lines[k]) == 0; k++)
      seen |= lines[k].seen;
    count_one(report, seen);
  }
  free(lines);
  for (int k = t->line_count; k < all->count; k++)
    if (all->varies[k]) count_one(report, all->seen[k]);
}
