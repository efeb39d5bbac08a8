#include "generator/grade/mark_page.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "generator/grade/curve_text.h"
#include "generator/grade/mark_text.h"
#include "generator/kernel/document.h"
#include "generator/page/diagram.h"
#include "generator/page/html.h"
#include "generator/page/shell.h"

/* "<TAG>text</TAG>", the text written out. */
static void put(FILE *out, const char *tag, const char *rest, const char *text) {
  fprintf(out, "<%s%s>", tag, rest);
  html_text(out, text);
  fprintf(out, "</%s>", tag);
}

static void put_points(FILE *out, double got, int points) {
  fprintf(out, "<td class=\"number %s\">%s</td><td class=\"number\">%d</td>",
          got >= points - 1e-9 ? "all" : "less", points_shown(got), points);
}

static void put_texts(const char *tag, const char *rest, const text_list *texts, FILE *out) {
  for (int k = 0; k < texts->count; k++)
    put(out, tag, rest, texts->items[k]);
}

/* --- the class -------------------------------------------------------------------------------- */

static void put_class(const exercise *e, const marks *all, int count, FILE *out) {
  fputs("<table><tr><th>Answer</th><th>Points</th><th>of</th><th></th></tr>\n", out);
  for (int k = 0; k < count; k++) {
    const mark_sums s = marks_add_up(e, &all[k]);
    fprintf(out, "<tr><td><a href=\"#a%d\">", k);
    html_text(out, all[k].name);
    fputs("</a></td>", out);
    put_points(out, s.got, s.judged);
    put(out, "td", "", marks_in_short(e, &all[k]));
    fputs("</tr>\n", out);
  }
  fputs("</table>\n", out);
}

/* --- curves ----------------------------------------------------------------------------------- */

typedef struct points {
  double x[CURVE_POINTS], y[CURVE_POINTS];
  int count;
} points;

/* Pairs of numbers to the end of the line. Returns what follows. */
static const char *read_points(const char *text, points *p) {
  const char *stop = text + strcspn(text, "\n");
  p->count = 0;
  while (text < stop && p->count < CURVE_POINTS) {
    char *end;
    const double x = strtod(text, &end);
    if (end == text || end > stop) break;
    text = end;
    const double y = strtod(text, &end);
    if (end == text || end > stop) break;
    text = end;
    if (!isfinite(x) || !isfinite(y)) continue;
    p->x[p->count] = x;
    p->y[p->count++] = y;
  }
  return *stop ? stop + 1 : stop;
}

enum { X_NAME, X_UNIT, Y_NAME, Y_UNIT, NAMES, NAME_LONGEST = 80 };

static const char *read_name(const char *text, char name[NAME_LONGEST]) {
  const int length = (int)strcspn(text, "\n");
  snprintf(name, NAME_LONGEST, "%.*s", length, text);
  return text[length] ? text + length + 1 : text + length;
}

void marks_curve(FILE *out, const char *text) {
  static const char *const words[] = {"right", "yours"};
  points *p = must_calloc(2, sizeof *p);
  char name[NAMES][NAME_LONGEST];
  diagram_curve curves[2];
  for (int k = 0; k < NAMES; k++)
    text = read_name(text, name[k]);
  for (int k = 0; k < 2; k++) {
    text = read_points(text, &p[k]);
    curves[k] =
        (diagram_curve){.x = p[k].x, .y = p[k].y, .count = p[k].count, .ink = k, .label = words[k]};
  }
  const diagram d = {.title = "both curves",
                     .x_name = name[X_NAME],
                     .x_unit = name[X_UNIT],
                     .y_name = name[Y_NAME],
                     .y_unit = name[Y_UNIT],
                     .curves = curves,
                     .count = 2};
  if (diagram_svg(out, &d)) diagram_legend(out, &d);
  free(p);
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
    fprintf(out, "<td class=\"number\">?</td><td class=\"number\">%d</td>", item->points);
  fputs("<td>", out);
  put(out, "strong", "", item->title);
  if (item->kind == ITEM_HAND) fputs(" (by hand)", out);
  if (i->of > 1 && i->passed < i->of)
    fprintf(out, ": %d of %d%s", i->passed, i->of, all_or_nothing(item));
  if (i->words && !m->sentence) put(out, "pre", "", i->words);
  if (i->state && !m->sentence) put_rows(m->memory, i->state, out);
  if (i->curve) marks_curve(out, i->curve);
  fputs("</td></tr>\n", out);
}

static void put_answer(const exercise *e, const marks *m, int number, FILE *out) {
  const mark_sums s = marks_add_up(e, m);
  fprintf(out, "<section class=\"marks\" id=\"a%d\">", number);
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
  char *text, error[500];
  size_t length;
  FILE *out = must_open_text(&text, &length);
  shell_begin(out, e->title);
  put(out, "h1", "", e->title);
  if (count != 1) put_class(e, all, count, out);
  for (int k = 0; k < count; k++)
    put_answer(e, &all[k], k, out);
  shell_end(out, NULL);
  must_close_text(out);
  const bool written = shell_write(path, text, length, error, sizeof error);
  if (!written) say_error("%s", error);
  free(text);
  return written;
}
