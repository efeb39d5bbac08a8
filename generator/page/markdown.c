#include "generator/page/markdown.h"

#include <stdbool.h>
#include <string.h>

#include "dsl/print/mathml.h"
#include "generator/page/html.h"

typedef struct paper {
  FILE *out;
  bool in_table, in_head;
} paper;

/* --- within a line ---------------------------------------------------------------------------- */

/* Where what is opened by `mark` closes; NULL: nowhere in the line. */
static const char *closing(const char *from, const char *end, const char *mark) {
  const size_t length = strlen(mark);
  for (const char *at = from; at + length <= end; at++)
    if (memcmp(at, mark, length) == 0) return at;
  return NULL;
}

/* The formula, code or character at hand; where it ends. */
static const char *put_piece(FILE *out, const char *at, const char *end) {
  const char *close;
  if (end - at > 1 && *at == '\\' && strchr("|*_`<$\\", at[1])) {
    html_bytes(out, at + 1, 1);
    return at + 2;
  }
  if (end - at > 2 && at[0] == '$' && at[1] == '$' && (close = closing(at + 2, end, "$$"))) {
    mathml_put(at + 2, (size_t)(close - at - 2), true, out);
    return close + 2;
  }
  if (*at == '$' && (close = closing(at + 1, end, "$"))) {
    mathml_put(at + 1, (size_t)(close - at - 1), false, out);
    return close + 1;
  }
  if (*at == '`' && (close = closing(at + 1, end, "`"))) {
    fputs("<code>", out);
    html_bytes(out, at + 1, (size_t)(close - at - 1));
    fputs("</code>", out);
    return close + 1;
  }
  size_t plain = 1;
  while (at + plain < end && !strchr("\\$`", at[plain]))
    plain++;
  html_bytes(out, at, plain);
  return at + plain;
}

static void put_line(FILE *out, const char *at, const char *end) {
  while (at < end)
    at = put_piece(out, at, end);
}

/* --- tables ----------------------------------------------------------------------------------- */

/* The bar that ends a cell: not one in code or in a formula, nor one behind a backslash. */
static const char *cell_end(const char *at, const char *end) {
  char inside = 0;
  for (; at < end; at++) {
    if (*at == '\\' && !inside)
      at++;
    else if (inside ? *at == inside : *at == '$' || *at == '`')
      inside = inside ? 0 : *at;
    else if (*at == '|' && !inside)
      return at;
  }
  return end;
}

static void put_row(paper *p, const char *at, const char *end) {
  const char *cell = p->in_head ? "th" : "td";
  fputs("<tr>", p->out);
  for (at++; at < end;) {
    const char *close = cell_end(at, end), *last = close;
    while (at < last && *at == ' ')
      at++;
    while (last > at && last[-1] == ' ')
      last--;
    fprintf(p->out, "<%s>", cell);
    put_line(p->out, at, last);
    fprintf(p->out, "</%s>", cell);
    at = close + 1;
  }
  fputs("</tr>\n", p->out);
}

static void end_table(paper *p) {
  if (p->in_table) fputs("</tbody></table></div>\n", p->out);
  p->in_table = false;
}

static void put_table_line(paper *p, const char *at, const char *end) {
  if (!p->in_table) {
    fputs("<div class=\"scroll\"><table><thead>", p->out);
    p->in_table = p->in_head = true;
    put_row(p, at, end);
    fputs("</thead><tbody>\n", p->out);
  } else if (p->in_head) /* of dashes */
    p->in_head = false;
  else
    put_row(p, at, end);
}

/* --- the whole -------------------------------------------------------------------------------- */

static void put_text_line(paper *p, const char *at, const char *end) {
  int level = 0;
  while (at + level < end && at[level] == '#')
    level++;
  if (level > 0) {
    const int shown = level < 5 ? level + 1 : 6;
    for (at += level; at < end && *at == ' ';)
      at++;
    fprintf(p->out, "<h%d>", shown);
    put_line(p->out, at, end);
    fprintf(p->out, "</h%d>\n", shown);
  } else if (end - at > 1 && at[0] == '$' && at[1] == '$') {
    fputs("<div class=\"equation\">", p->out);
    put_line(p->out, at, end);
    fputs("</div>\n", p->out);
  } else if (at < end) {
    fputs("<p>", p->out);
    put_line(p->out, at, end);
    fputs("</p>\n", p->out);
  }
}

static bool is_skipped(const char *at, const char *end, const char *const *skip) {
  while (at < end && (*at == '#' || *at == ' '))
    at++;
  for (int k = 0; skip && skip[k]; k++)
    if (strlen(skip[k]) == (size_t)(end - at) && memcmp(skip[k], at, (size_t)(end - at)) == 0)
      return true;
  return false;
}

void markdown_put(FILE *out, const char *text, const char *const *skip) {
  paper p = {.out = out};
  bool skipped = false;
  while (*text) {
    const char *end = text + strcspn(text, "\n");
    if (*text == '#') skipped = is_skipped(text, end, skip);
    if (*text != '|' || skipped) end_table(&p);
    if (skipped)
      ;
    else if (*text == '|')
      put_table_line(&p, text, end);
    else
      put_text_line(&p, text, end);
    text = end + (*end == '\n');
  }
  end_table(&p);
}
