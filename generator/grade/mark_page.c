#include "generator/grade/mark_page.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "generator/grade/curve_text.h"
#include "generator/grade/mark_files.h"
#include "generator/grade/mark_text.h"
#include "generator/kernel/document.h"
#include "runtime/base/whole_file.h"

static const char head[] =
    "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
    "'unsafe-inline'\">\n"
    "<meta name=\"viewport\" content=\"width=device-width\">\n<style>\n"
    "body{font:16px/1.45 system-ui,sans-serif;color:#1a1a1a;max-width:60rem;margin:2rem "
    "auto;padding:0 1rem}\n"
    "table{border-collapse:collapse}td,th{padding:.2rem .7rem;text-align:left;vertical-align:top;"
    "border-bottom:1px solid #ddd}\n"
    "td.n{text-align:right;font-variant-numeric:tabular-nums}.less{color:#b3261e}.all{color:#"
    "1b6e3a}"
    "\n.say{border-left:4px solid #d98200;padding:.3rem .8rem;background:#fff7e8}\n"
    "pre{background:#f4f4f4;padding:.5rem;white-space:pre-wrap;overflow-wrap:anywhere}section{"
    "margin-top:2.5rem}\n"
    ".rows{font-size:.8rem;font-variant-numeric:tabular-nums}.rows td{padding:.1rem .5rem}\n"
    "svg{width:30rem;max-width:100%;display:block}td pre{max-width:44rem}\n</style>\n<title>";

/* "<TAG>text</TAG>", the text written out. */
static void put(FILE *out, const char *tag, const char *rest, const char *text) {
  fprintf(out, "<%s%s>", tag, rest);
  xml_text(out, text);
  fprintf(out, "</%s>", tag);
}

static void put_points(FILE *out, double got, int points) {
  fprintf(out, "<td class=\"n %s\">%s</td><td class=\"n\">%d</td>",
          got >= points - 1e-9 ? "all" : "less", points_shown(got), points);
}

static void put_texts(const char *tag, const char *rest, const text_list *texts, FILE *out) {
  for (int k = 0; k < texts->count; k++)
    put(out, tag, rest, texts->items[k]);
}

/* --- the class -------------------------------------------------------------------------------- */

static void put_class(const exercise *e, const marks *all, int count, FILE *out) {
  fputs("<table><tr><th>Answer<th>Points<th>of<th></tr>\n", out);
  for (int k = 0; k < count; k++) {
    const mark_sums s = marks_add_up(e, &all[k]);
    fprintf(out, "<tr><td><a href=\"#a%d\">", k);
    xml_text(out, all[k].name);
    fputs("</a></td>", out);
    put_points(out, s.got, s.judged);
    put(out, "td", "", marks_in_short(e, &all[k]));
    fputs("</tr>\n", out);
  }
  fputs("</table>\n", out);
}

/* --- one answer ------------------------------------------------------------------------------- */

/* Rows of a state as a table: two blanks or more end a column. */
static void put_rows(arena *a, const char *text, FILE *out) {
  fputs("<table class=\"rows\">", out);
  while (*text) {
    const char *end = text + strcspn(text, "\n");
    fputs("<tr>", out);
    while (text < end) {
      const char *next = strstr(text, "  ");
      if (!next || next > end) next = end;
      put(out, "td", "", arena_text(a, text, (size_t)(next - text)));
      text = next + strspn(next, " ");
    }
    fputs("</tr>", out);
    text = end + (*end == '\n');
  }
  fputs("</table>", out);
}

static void put_item(const exercise_item *item, const item_mark *i, const marks *m, FILE *out) {
  fputs("<tr>", out);
  if (i->judged || (m->trouble && item->kind != ITEM_HAND))
    put_points(out, i->share * item->points, item->points);
  else
    fprintf(out, "<td class=\"n\">?</td><td class=\"n\">%d</td>", item->points);
  fputs("<td>", out);
  put(out, "strong", "", item->title);
  if (item->kind == ITEM_HAND) fputs(" (by hand)", out);
  if (i->of > 1 && i->passed < i->of)
    fprintf(out, ": %d of %d%s", i->passed, i->of, all_or_nothing(item));
  if (i->words && !m->sentence) put(out, "pre", "", i->words);
  if (i->state && !m->sentence) put_rows(m->memory, i->state, out);
  if (i->curve) curve_svg(i->curve, out);
  fputs("</td></tr>\n", out);
}

static void put_answer(const exercise *e, const marks *m, int number, FILE *out) {
  const mark_sums s = marks_add_up(e, m);
  fprintf(out, "<section id=\"a%d\">", number);
  put(out, "h2", "", m->name);
  put_texts("pre", "", &m->messages, out);
  if (m->sentence) put(out, "p", " class=\"say\"", m->sentence);
  if (m->trouble) put(out, "p", " class=\"say\"", m->trouble);
  fputs("<table>", out);
  for (int k = 0; k < e->item_count; k++)
    put_item(&e->items[k], &m->items[k], m, out);
  fputs("<tr>", out);
  put_points(out, s.got, s.judged);
  fputs("<td>points", out);
  if (s.elsewhere) fprintf(out, "; %d are judged by the teacher", s.elsewhere);
  if (s.by_hand) fprintf(out, "; %d are given by hand", s.by_hand);
  fputs("</td></tr></table>\n", out);
  if (m->advice.count) put(out, "p", "", advice_costs_nothing);
  put_texts("pre", "", &m->advice, out);
  put_texts("p", "", &m->notes, out);
  fputs("</section>\n", out);
}

bool marks_page(const exercise *e, const marks *all, int count, const char *path) {
  whole_file f;
  FILE *out = whole_file_open(&f, path);
  if (out) {
    fputs(head, out);
    xml_text(out, e->title);
    fputs("</title></head><body>\n", out);
    put(out, "h1", "", e->title);
    if (count != 1) put_class(e, all, count, out);
    for (int k = 0; k < count; k++)
      put_answer(e, &all[k], k, out);
    fputs("</body></html>\n", out);
    const bool whole = !ferror(out), closed = fclose(out) == 0;
    if (whole_file_end(&f, whole && closed)) return true;
  }
  say_error("cannot write `%s`: %s", path, strerror(errno));
  return false;
}
