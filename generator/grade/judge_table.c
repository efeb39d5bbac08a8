#include "generator/grade/judge_table.h"

#include <math.h>
#include <string.h>

#include "generator/against/table_difference.h"
#include "generator/exercise/answer_table.h"

typedef struct judging {
  const judge_request *q;
  arena *memory;
  FILE *out;
  answer_table answer, right;
  bool all_right;
} judging;

static void put_words(const judging *j, int item, const char *words) {
  if (j->q->basis->of->items[item].show != SHOW_NOTHING)
    record_write(j->out, RECORD_WORDS, item, NULL, words);
}

/* Why one answer is wrong. */
static const char *words_of(const judging *j, const answer_entry *right, const answer_entry *x) {
  arena *a = j->memory;
  if (!x) return arena_printf(a, "%s: there is no such line", right->name);
  if (!x->filled) return arena_printf(a, "%s is still to be written", right->name);
  if (!right->is_number) return arena_printf(a, "%s is wrong", right->name);
  if (!x->is_number) return arena_printf(a, "%s is no number with a unit", right->name);
  if (x->has_unit && right->has_unit && !dim_equal(x->dim, right->dim)) {
    char has[96], needs[96];
    dim_describe(x->dim, has, sizeof has);
    dim_describe(right->dim, needs, sizeof needs);
    return arena_printf(a, "%s is %s, not %s", right->name, needs, has);
  }
  const double ratio = x->value / right->value;
  char formula[64];
  const char *known = isfinite(ratio) ? ratio_words(fabs(ratio)) : NULL;
  if (isfinite(ratio) && !known && ratio_formula(fabs(ratio), formula, sizeof formula))
    known = arena_printf(a, "%s times", formula);
  if (fabs(ratio) < 1e-9) return arena_printf(a, "%s is 0", right->name);
  if (known)
    return arena_printf(a, "%s is %s%s what it should be", right->name, ratio < 0 ? "minus " : "",
                        known);
  return arena_printf(a, "%s is wrong%s", right->name,
                      isfinite(ratio) && right->value != 0
                          ? ratio > 1 ? ": it is too large" : ": it is too small"
                          : "");
}

static void judge_item(judging *j, int k) {
  const exercise_item *item = &j->q->basis->of->items[k];
  int passed = 0;
  for (int n = 0; n < j->right.count; n++) {
    const answer_entry *right = &j->right.entries[n], *x = answer_find(&j->answer, right->name);
    const bool good = x && answers_agree(x, right, item->tolerance);
    passed += good;
    if (!good) put_words(j, k, words_of(j, right, x));
  }
  const double share = j->right.count ? (double)passed / j->right.count : 0;
  record_write(j->out, RECORD_MARK, k, (const double[4]){share, passed, j->right.count, NAN}, NULL);
  j->all_right = j->all_right && passed == j->right.count;
}

/* How many of what is wrong in a known wrong table is so in the answer; 0 unless all is. */
static int alike(const judging *j, const answer_table *wrong, double tolerance) {
  int count = 0;
  for (int n = 0; n < j->right.count; n++) {
    const answer_entry *right = &j->right.entries[n], *w = answer_find(wrong, right->name),
                       *x = answer_find(&j->answer, right->name);
    if (!w || answers_agree(w, right, tolerance)) continue;
    if (!x || !answers_agree(x, w, tolerance)) return 0;
    count++;
  }
  return count;
}

static void find_known(const judging *j, double tolerance) {
  const exercise *e = j->q->basis->of;
  int best = 0, known = -1;
  const char *bad;
  for (int w = 0; w < e->wrong_count && !j->all_right; w++) {
    answer_table wrong;
    if (!answer_table_read(&wrong, j->memory, e->wrong[w].path, &bad)) continue;
    const int count = alike(j, &wrong, tolerance);
    if (count <= best) continue;
    best = count;
    known = w;
  }
  if (known >= 0)
    record_write(j->out, RECORD_SENTENCE, -1, (const double[4]){known, 0, 0, 0},
                 e->wrong[known].sentence);
}

/* Lines that are not answers, and answers that are not written yet; they are told without the
   solution, too. */
static void put_notes(const judging *j) {
  int empty = 0;
  for (int k = 0; k < j->answer.count; k++)
    empty += !j->answer.entries[k].filled;
  if (empty)
    record_write(j->out, RECORD_NOTE, -1, NULL,
                 arena_printf(j->memory, "%d answer%s still to be written", empty,
                              empty == 1 ? " is" : "s are"));
  if (j->answer.lines_unread)
    record_write(j->out, RECORD_NOTE, -1, NULL,
                 arena_printf(j->memory, "%d line%s not `name = value`", j->answer.lines_unread,
                              j->answer.lines_unread == 1 ? " is" : "s are"));
}

void judge_table(const judge_request *q, FILE *out) {
  const exercise *e = q->basis->of;
  judging j = {.q = q, .memory = arena_new(), .out = out, .all_right = true};
  const char *bad;
  /* what students have is without a solution, and withholds what it needs */
  const bool read = (!e->solution || answer_table_read(&j.right, j.memory, e->solution, &bad)) &&
                    answer_table_read(&j.answer, j.memory, q->answer, &bad);
  for (int k = 0; k < e->item_count && read; k++)
    if (e->items[k].kind == ITEM_ANSWERS && item_is_judged(&e->items[k], q->only_public)) {
      judge_item(&j, k);
      find_known(&j, e->items[k].tolerance);
    }
  put_notes(&j);
  if (read) record_write(out, RECORD_END, -1, NULL, NULL);
  arena_free(j.memory);
}
