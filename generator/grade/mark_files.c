#include "generator/grade/mark_files.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "dsl/base/characters.h"
#include "generator/exercise/exercise_grammar.h"
#include "generator/grade/mark_text.h"
#include "generator/kernel/document.h"
#include "runtime/base/whole_file.h"

/* --- JSON ------------------------------------------------------------------------------------- */

static void item_json(const exercise_item *item, const item_mark *i, json *j) {
  json_object(j);
  json_put_text(j, "title", item->title);
  json_put_text(j, "kind", item_kind_names[item->kind]);
  json_put_bool(j, "hidden", item->hidden);
  json_put_integer(j, "points", item->points);
  json_put_bool(j, "judged", i->judged);
  json_put_number(j, "got", i->judged ? i->share * item->points : NAN);
  json_put_integer(j, "passed", i->passed);
  json_put_integer(j, "of", i->of);
  json_put_text(j, "words", i->words);
  json_put_text(j, "state", i->state);
  json_object_end(j);
}

/* Always an array. */
static void texts_json(const char *name, const text_list *texts, json *j) {
  json_put_array(j, name);
  for (int k = 0; k < texts->count; k++)
    json_text(j, texts->items[k]);
  json_array_end(j);
}

void marks_json(const exercise *e, const marks *m, json *j) {
  const mark_sums s = marks_add_up(e, m);
  json_object(j);
  json_put_text(j, "name", m->name);
  json_put_number(j, "got", s.got);
  json_put_integer(j, "points", s.judged);
  json_put_integer(j, "by_hand", s.by_hand);
  json_put_integer(j, "elsewhere", s.elsewhere);
  json_put_integer(j, "holes", m->holes);
  json_put_integer(j, "errors", m->errors);
  json_put_integer(j, "warnings", m->warnings);
  texts_json("messages", &m->messages, j);
  texts_json("advice", &m->advice, j);
  json_put_text(j, "sentence", m->sentence);
  json_put_text(j, "known",
                m->known >= 0 && m->known < e->wrong_count ? e->wrong[m->known].name : NULL);
  json_put_text(j, "trouble", m->trouble);
  json_put_integer(j, "cases", m->cases);
  json_put_integer(j, "reached", m->reached);
  texts_json("notes", &m->notes, j);
  json_put_number(j, "seconds", m->seconds);
  json_put_array(j, "items");
  for (int k = 0; k < e->item_count; k++)
    item_json(&e->items[k], &m->items[k], j);
  json_array_end(j);
  json_object_end(j);
}

/* --- files ------------------------------------------------------------------------------------ */

static FILE *begin(whole_file *f, const char *path) {
  FILE *out = whole_file_open(f, path);
  if (!out) say_error("cannot write `%s`: %s", path, strerror(errno));
  return out;
}

static bool end(FILE *out, const whole_file *f, const char *path) {
  const bool whole = !ferror(out), closed = fclose(out) == 0;
  if (whole_file_end(f, whole && closed)) return true;
  say_error("cannot write `%s`: %s", path, strerror(errno));
  return false;
}

/* In quotes, on one line; a program for tables takes nothing of it for a formula. */
static void csv_text(FILE *out, const char *text) {
  fputc('"', out);
  if (*text && strchr("=+-@\t\r", *text)) fputc('\'', out);
  for (; *text; text++) {
    if (*text == '"') fputc('"', out);
    fputc((unsigned char)*text < ' ' ? ' ' : *text, out); /* one line, no control characters */
  }
  fputc('"', out);
}

static void csv_row(const exercise *e, const marks *m, FILE *out) {
  const mark_sums s = marks_add_up(e, m);
  csv_text(out, m->name);
  fprintf(out, ",%s,%d", points_shown(s.got), s.judged);
  for (int k = 0; k < e->item_count; k++) {
    fputc(',', out);
    if (m->items[k].judged) fputs(points_shown(m->items[k].share * e->items[k].points), out);
  }
  fprintf(out, ",%.2f,", m->seconds);
  csv_text(out, marks_in_short(e, m));
  fputc('\n', out);
}

bool marks_csv(const exercise *e, const marks *all, int count, const char *path) {
  whole_file f;
  FILE *out = begin(&f, path);
  if (!out) return false;
  fputs("name,points,of", out);
  for (int k = 0; k < e->item_count; k++) {
    fputc(',', out);
    csv_text(out, e->items[k].title);
  }
  fputs(",seconds,words\n", out);
  for (int k = 0; k < count; k++)
    csv_row(e, &all[k], out);
  return end(out, &f, path);
}

/* --- JUnit ------------------------------------------------------------------------------------ */

/* Control characters are left out: XML has none. */
static void xml_text(FILE *out, const char *text) {
  for (; *text; text++)
    if ((unsigned char)*text >= ' ' || *text == '\n' || *text == '\t') markup_put(out, *text);
}

static bool is_short(const exercise_item *item, const item_mark *i, const marks *m) {
  if (item->kind == ITEM_HAND) return false;
  return i->judged ? i->share < 1 : m->trouble != NULL;
}

static void junit_case(const exercise *e, const marks *m, int k, FILE *out) {
  const exercise_item *item = &e->items[k];
  const item_mark *i = &m->items[k];
  const char *words = m->trouble && !i->judged ? m->trouble
                      : m->sentence            ? m->sentence
                      : i->words               ? i->words
                      : m->messages.count      ? m->messages.items[0]
                                               : "";
  fputs("    <testcase classname=\"", out);
  xml_text(out, m->name);
  fputs("\" name=\"", out);
  xml_text(out, item->title);
  fputs("\">", out);
  if (is_short(item, i, m)) {
    fprintf(out, "\n      <failure message=\"%s of %d points\">",
            points_shown(i->share * item->points), item->points);
    xml_text(out, words);
    fputs("</failure>\n    ", out);
  } else if (!i->judged) {
    fputs("<skipped/>", out);
  }
  fputs("</testcase>\n", out);
}

bool marks_junit(const exercise *e, const marks *all, int count, const char *path) {
  whole_file f;
  FILE *out = begin(&f, path);
  if (!out) return false;
  fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n", out);
  for (int a = 0; a < count; a++) {
    int failures = 0, skipped = 0;
    for (int k = 0; k < e->item_count; k++) {
      const bool less = is_short(&e->items[k], &all[a].items[k], &all[a]);
      failures += less;
      skipped += !less && !all[a].items[k].judged;
    }
    fputs("  <testsuite name=\"", out);
    xml_text(out, e->name);
    fputs(" ", out);
    xml_text(out, all[a].name);
    fprintf(out, "\" tests=\"%d\" failures=\"%d\" skipped=\"%d\" time=\"%.3f\">\n", e->item_count,
            failures, skipped, all[a].seconds);
    for (int k = 0; k < e->item_count; k++)
      junit_case(e, &all[a], k, out);
    fputs("  </testsuite>\n", out);
  }
  fputs("</testsuites>\n", out);
  return end(out, &f, path);
}
