#include "generator/grade/mark_text.h"

#include <math.h>
#include <string.h>

#include "dsl/base/characters.h"
#include "generator/exercise/exercise_grammar.h"

const char advice_costs_nothing[] = "warnings of `perilat check`, which cost nothing:";

const char *points_shown(double points) {
  static _Thread_local char texts[4][32];
  static _Thread_local int next;
  char *text = texts[next = (next + 1) % 4];
  snprintf(text, sizeof texts[0], "%.4g", round(1e3 * points) / 1e3 + 0.0);
  return text;
}

mark_sums marks_add_up(const exercise *e, const marks *m) {
  mark_sums s = {0, 0, 0, 0};
  for (int k = 0; k < e->item_count; k++) {
    const exercise_item *item = &e->items[k];
    if (item->kind == ITEM_HAND)
      s.by_hand += item->points;
    else if (!m->items[k].judged && !m->trouble)
      s.elsewhere += item->points;
    else
      s.judged += item->points;
    s.got += m->items[k].judged ? m->items[k].share * item->points : 0;
  }
  return s;
}

bool marks_are_full(const exercise *e, const marks *m) {
  const mark_sums s = marks_add_up(e, m);
  return !m->trouble && s.got >= s.judged - 1e-9;
}

/* Each line of a text behind an indent. */
static void print_lines(const char *text, const char *indent, FILE *out) {
  while (*text) {
    const size_t length = strcspn(text, "\n");
    fprintf(out, "%s%.*s\n", indent, (int)length, text);
    text += length + (text[length] == '\n');
  }
}

static void print_texts(const text_list *texts, const char *indent, FILE *out) {
  for (int k = 0; k < texts->count; k++)
    print_lines(texts->items[k], indent, out);
}

/* The sentence of a known wrong law says it all. */
static bool needs_words(const exercise_item *item, const marks *m) {
  return !m->sentence || item->kind == ITEM_ANSWERS;
}

const char *all_or_nothing(const exercise_item *item) {
  return item->kind == ITEM_SAMPLE ? ", all or nothing" : "";
}

static void print_item(const exercise_item *item, const item_mark *i, const marks *m, FILE *out) {
  const char *title = name_shown(item->title);
  if (item->kind == ITEM_HAND) {
    fprintf(out, "      ? of %3d  %s: by hand\n", item->points, title);
    return;
  }
  if (!i->judged && !m->trouble) {
    fprintf(out, "      ? of %3d  %s: hidden, judged by the teacher\n", item->points, title);
    return;
  }
  fprintf(out, "  %5s of %3d  %s", points_shown(i->share * item->points), item->points, title);
  if (i->of > 1 && i->passed < i->of)
    fprintf(out, ": %d of %d%s", i->passed, i->of, all_or_nothing(item));
  fputc('\n', out);
  if (i->words && needs_words(item, m)) print_lines(i->words, "                ", out);
  if (i->state && needs_words(item, m)) print_lines(i->state, "                  ", out);
}

static void print_sum(const exercise *e, const marks *m, FILE *out) {
  const mark_sums s = marks_add_up(e, m);
  fprintf(out, "  %5s of %3d  points", points_shown(s.got), s.judged);
  if (s.elsewhere) fprintf(out, "; %d are judged by the teacher", s.elsewhere);
  if (s.by_hand) fprintf(out, "; %d are given by hand", s.by_hand);
  fputc('\n', out);
}

void marks_print(const exercise *e, const marks *m, FILE *out) {
  fprintf(out, "%s: %s\n", name_shown(m->name), name_shown(e->title));
  if (m->holes)
    fprintf(out, "  %d hole%s `?` %s still to be written\n", m->holes, m->holes == 1 ? "" : "s",
            m->holes == 1 ? "is" : "are");
  print_texts(&m->messages, "  ", out);
  if (m->sentence) print_lines(m->sentence, "  ", out);
  for (int k = 0; k < e->item_count; k++)
    print_item(&e->items[k], &m->items[k], m, out);
  if (m->trouble) fprintf(out, "  not judged to the end: %s\n", m->trouble);
  if (m->advice.count) fprintf(out, "  %s\n", advice_costs_nothing);
  print_texts(&m->advice, "  ", out);
  print_texts(&m->notes, "  note: ", out);
  print_sum(e, m, out);
}

const char *marks_in_short(const exercise *e, const marks *m) {
  if (m->trouble) return m->trouble;
  if (m->holes) return "holes are still to be written";
  if (m->sentence) return m->sentence;
  if (m->errors) return "the law has errors";
  bool is_compared = false;
  const char *words = "";
  for (int k = e->item_count - 1; k >= 0; k--) {
    const bool compared = e->items[k].kind == ITEM_PATH && m->items[k].state;
    if (m->items[k].words && (compared || !*words || !is_compared)) words = m->items[k].words;
    is_compared = is_compared || (m->items[k].words && compared);
  }
  return arena_text(m->memory, words, strcspn(words, "\n"));
}
