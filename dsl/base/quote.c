#include "dsl/base/quote.h"

#include <string.h>

#include "dsl/base/characters.h"
#include "dsl/base/terminal.h"

enum { LONGEST = 160, TAB = 8, DOTS = 3, LEAST_ROOM = 8 };

/* A line's bytes, those that are underlined, those that are shown. */
typedef struct quotation {
  const char *text;
  size_t length, begin, end, from, to;
  int first_column; /* of the terminal, where the text begins: tabs lead from there */
} quotation;

static quotation find_line(const source_set *sources, span where) {
  quotation q = {.text = NULL};
  q.text = source_line(sources, where.file, where.begin, &q.length);
  const size_t line_begin = (size_t)(q.text - sources->items[where.file].text);
  q.begin = where.begin - line_begin < q.length ? where.begin - line_begin : q.length;
  q.end = where.end > line_begin + q.length ? q.length : where.end - line_begin;
  if (where.end <= where.begin) q.end = q.begin;
  q.to = q.length;
  return q;
}

/* Column behind a character that begins at `column`. */
static int column_after(const shown_character *c, int column) {
  return *c->text == '\t' ? column + TAB - column % TAB : column + c->columns;
}

static shown_character character_at(const quotation *q, size_t at) {
  return character_shown(q->text + at, q->length - at);
}

/* The first byte that no longer fits into `room` columns from byte `from`. */
static size_t end_of_room(const quotation *q, size_t from, int room) {
  int column = q->first_column + (from > 0 ? DOTS : 0);
  const int last = column + room;
  size_t at = from;
  while (at < q->length) {
    const shown_character c = character_at(q, at);
    column = column_after(&c, column);
    if (column > last) break;
    at += c.length;
  }
  return at;
}

/* The byte from which about `room` columns lead to byte `to`. */
static size_t begin_of_room(const quotation *q, size_t to, int room) {
  size_t at = to;
  while (at > 0) {
    size_t before = at - 1;
    while (before > 0 && at - before < 4 && utf8_length(q->text + before, at - before) == 0)
      before--;
    if (utf8_length(q->text + before, at - before) != at - before) before = at - 1;
    const shown_character c = character_at(q, before);
    room -= *c.text == '\t' ? TAB : c.columns;
    if (room < 0) break;
    at = before;
  }
  return at;
}

/* What is shown of a line that is longer than `whole` columns: `room` of them, the caret in the
   first part unless the line ends before. */
static void cut(quotation *q, int whole, int room) {
  if (end_of_room(q, 0, whole) == q->length) return;
  q->from = begin_of_room(q, q->begin, room * 3 / 8);
  if (end_of_room(q, q->from, room) == q->length) q->from = begin_of_room(q, q->length, room);
  q->to = end_of_room(q, q->from, room);
}

static void print_text(const quotation *q, FILE *out) {
  fputs(q->from > 0 ? "..." : "", out);
  characters_show(out, q->text + q->from, q->to - q->from);
  fputs(q->to < q->length ? "...\n" : "\n", out);
}

static void print_times(char c, int count, FILE *out) {
  for (; count > 0; count--)
    fputc(c, out);
}

static void print_caret(const quotation *q, FILE *out) {
  size_t at = q->from;
  print_times(' ', at > 0 ? DOTS : 0, out);
  while (at < q->begin) {
    const shown_character c = character_at(q, at);
    print_times(*c.text == '\t' ? '\t' : ' ', c.columns, out);
    at += c.length;
  }
  terminal_paint_with(out, PAINT_CARET);
  int columns = 0;
  while (at < q->end && at < q->to) {
    const shown_character c = character_at(q, at);
    columns += c.columns;
    at += c.length;
  }
  fputc('^', out);
  print_times('~', columns - 1, out);
  terminal_paint_with(out, PAINT_PLAIN);
  fputc('\n', out);
}

void quote_line(const source_set *sources, span where, FILE *out) {
  quotation q = find_line(sources, where);
  const int digits = fprintf(out, "  %d", source_line_number(sources, where.file, where.begin));
  q.first_column = digits + (int)strlen(" | ");
  const int columns = terminal_columns(out), left = columns - q.first_column;
  if (columns == 0)
    cut(&q, LONGEST, LONGEST);
  else
    cut(&q, left, left - 2 * DOTS > LEAST_ROOM ? left - 2 * DOTS : LEAST_ROOM);
  fputs(" | ", out);
  print_text(&q, out);
  fprintf(out, "%*s | ", digits, "");
  print_caret(&q, out);
}
