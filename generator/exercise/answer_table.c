#include "generator/exercise/answer_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "generator/kernel/model.h"
#include "runtime/deck/deck_value.h"

enum { MOST_ENTRIES = 1000 };

static const char blanks[] = " \t\r";

/* Without blanks at both ends. */
static const char *trimmed(arena *a, const char *text, size_t length) {
  const size_t begin = strspn(text, blanks);
  if (begin >= length) return "";
  text += begin;
  length -= begin;
  while (length > 0 && strchr(blanks, text[length - 1]))
    length--;
  return arena_text(a, text, length);
}

static bool is_a_name(const char *name) {
  if (!*name) return false;
  for (; *name; name++)
    if (!strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_", *name))
      return false;
  return true;
}

/* As a deck's value would be. */
static void read_value(answer_entry *e) {
  source_set sources = {NULL, 0};
  diagnostics unheard;
  double number;
  deck_quantity q;
  const size_t length = strlen(e->text);
  e->filled = length > 0 && e->text[0] != '?';
  diag_begin(&unheard, &sources);
  const span where = source_whole(&sources, source_add(&sources, "answer", e->text, length));
  namelist_value v = {.kind = NAMELIST_TEXT, .text = e->text, .where = where, .text_where = where};
  if (length && namelist_number(e->text, length, &number) == length && isfinite(number)) {
    v.kind = NAMELIST_NUMBER;
    v.number = number;
  }
  if (e->filled && deck_quantity_read(&v, "answer", &q, &unheard)) {
    e->is_number = true;
    e->value = q.value;
    e->has_unit = q.has_unit;
    e->dim = q.dim;
  }
  diag_clear(&unheard);
  source_clear(&sources);
}

static void read_line(answer_table *t, arena *a, const char *line, size_t length) {
  const char *comment = memchr(line, '!', length);
  if (comment) length = (size_t)(comment - line);
  const char *sign = memchr(line, '=', length);
  if (!sign) {
    t->lines_unread += *trimmed(a, line, length) != 0;
    return;
  }
  answer_entry e = {.name = trimmed(a, line, (size_t)(sign - line))};
  if (!is_a_name(e.name) || t->count == MOST_ENTRIES) {
    t->lines_unread++;
    return;
  }
  e.text = trimmed(a, sign + 1, length - (size_t)(sign + 1 - line));
  read_value(&e);
  t->entries[t->count++] = e;
}

bool answer_table_read(answer_table *t, arena *a, const char *path, const char **bad) {
  char error[1024];
  size_t length;
  char *text = read_text_file(path, MODEL_LIMIT, &length, error, sizeof error);
  *t = (answer_table){.entries = arena_alloc(a, (MOST_ENTRIES + 1) * sizeof *t->entries)};
  if (!text) {
    *bad = arena_text(a, error, strlen(error));
    return false;
  }
  for (const char *line = text; *line;) {
    const size_t size = strcspn(line, "\n");
    read_line(t, a, line, size);
    line += size + (line[size] == '\n');
  }
  free(text);
  return true;
}

const answer_entry *answer_find(const answer_table *t, const char *name) {
  for (int k = 0; k < t->count; k++)
    if (strcasecmp(t->entries[k].name, name) == 0) return &t->entries[k];
  return NULL;
}

bool answers_agree(const answer_entry *x, const answer_entry *right, double tolerance) {
  if (!x->filled) return false;
  if (!right->is_number) return strcasecmp(x->text, right->text) == 0;
  if (!x->is_number) return false;
  if (x->has_unit && right->has_unit && !dim_equal(x->dim, right->dim)) return false;
  return fabs(x->value - right->value) <= tolerance * fabs(right->value);
}
