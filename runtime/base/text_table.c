#include "runtime/base/text_table.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/base/unit_hint.h"

enum { WORDS_LENGTH = 300 };

/* --- fields of a line ------------------------------------------------------------------------- */

typedef struct field {
  const char *from, *to; /* without blanks and quotes around */
} field;

static bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

static const char *line_end(const char *p) {
  return p + strcspn(p, "\n");
}

static field trimmed(const char *from, const char *to) {
  while (from < to && is_blank(*from))
    from++;
  while (to > from && is_blank(to[-1]))
    to--;
  if (to - from >= 2 && *from == '"' && to[-1] == '"') return (field){from + 1, to - 1};
  return (field){from, to};
}

/* The next separator that does not stand in quotes, or `end`. */
static const char *field_end(const char *p, const char *end, char separator) {
  for (bool quoted = false; p < end; p++) {
    if (*p == '"') quoted = !quoted;
    if (*p == separator && !quoted) return p;
  }
  return end;
}

/* In a line of words: a word, and the unit in brackets behind it. */
static const char *word_end(const char *p, const char *end) {
  while (p < end && is_blank(*p))
    p++;
  while (p < end && !is_blank(*p))
    p++;
  const char *more = p;
  while (more < end && is_blank(*more))
    more++;
  const char *close = more < end && *more == '[' ? memchr(more, ']', (size_t)(end - more)) : NULL;
  return close ? close + 1 : p;
}

/* The field at `p`; `*next` is where the next one begins, or NULL behind the last. */
static field read_field(const text_table *t, const char *p, const char *end, const char **next) {
  const char *to = t->separator == ' ' ? word_end(p, end) : field_end(p, end, t->separator);
  const field rest = trimmed(to, end);
  if (t->separator == ' ')
    *next = rest.from < rest.to ? rest.from : NULL;
  else
    *next = to < end ? to + 1 : NULL;
  return trimmed(p, to);
}

static char separator_of(const char *line) {
  const char *end = line_end(line);
  for (const char *s = "\t;,"; *s; s++)
    if (field_end(line, end, *s) < end) return *s;
  return ' ';
}

static bool as_number(field f, double *value) {
  char *rest;
  *value = strtod(f.from, &rest);
  return f.from < f.to && rest == f.to;
}

/* --- lines ------------------------------------------------------------------------------------ */

static bool begins_line(const char *p, const char *end) {
  while (p < end && is_blank(*p))
    p++;
  return p < end && *p != '#';
}

/* The next line that is neither blank nor a comment; NULL behind the last. */
static const char *find_line(const text_table *t, const char *p) {
  while (p < t->file.text + t->file.length) {
    const char *end = line_end(p);
    if (begins_line(p, end)) return p;
    p = end < t->file.text + t->file.length ? end + 1 : end;
  }
  return NULL;
}

static const char *line_after(const text_table *t, const char *line) {
  const char *end = line_end(line);
  return end < t->file.text + t->file.length ? end + 1 : end;
}

static uint32_t at(const text_table *t, const char *p) {
  return (uint32_t)(p - t->file.text);
}

static span line_span(text_table *t, const char *line, diagnostics *d) {
  return file_text_span(&t->file, line, line + strcspn(line, "\r\n"), d);
}

static field cell_of(const text_table *t, long row, int column) {
  const char *p = t->file.text + t->begin[row], *end = line_end(p);
  field f = {p, p};
  for (int k = 0; k <= column && p; k++)
    f = read_field(t, p, end, &p);
  return f;
}

static int fields_in(const text_table *t, const char *line) {
  int count = 0;
  for (const char *p = line, *end = line_end(line); p; count++)
    read_field(t, p, end, &p);
  return count;
}

/* Each line has a number in each column, or at least a place for it. */
static bool find_rows(text_table *t, const char *line, diagnostics *d) {
  long room = 0;
  for (; line; line = find_line(t, line_after(t, line))) {
    const int fields = fields_in(t, line);
    if (fields != t->column_count) {
      diag_report(d, DIAG_BAD_VALUE, line_span(t, line, d),
                  "this line has %s values than the %d columns",
                  fields > t->column_count ? "more" : "fewer", t->column_count);
      return false;
    }
    if (t->rows == room) {
      room = 2 * room + 256;
      t->begin = must_realloc(t->begin, (size_t)room * sizeof *t->begin);
    }
    t->begin[t->rows++] = at(t, line);
  }
  return true;
}

/* --- columns ---------------------------------------------------------------------------------- */

static bool is_unit(const char *from, const char *to) {
  return to > from && unit_is_whole(from, (size_t)(to - from));
}

/* The last opening parenthesis of a title that ends with one; NULL without a unit in it. */
static const char *find_parenthesis(field f) {
  const char *p = f.to;
  if (p == f.from || p[-1] != ')') return NULL;
  while (p > f.from && *p != '(')
    p--;
  return *p == '(' && is_unit(p + 1, f.to - 1) ? p : NULL;
}

/* "name [unit]"; "name (unit)" where that is a unit. False after a message. */
static bool read_title(text_table *t, field f, text_column *c, diagnostics *d) {
  const char *bracket = memchr(f.from, '[', (size_t)(f.to - f.from));
  const char *open = bracket ? bracket : find_parenthesis(f);
  if (bracket && f.to[-1] != ']') {
    diag_report(d, DIAG_SYNTAX, file_text_span(&t->file, bracket, f.to, d),
                "this unit has no closing `]`");
    return false;
  }
  const field name = trimmed(f.from, open ? open : f.to);
  *c = (text_column){.begin = at(t, f.from), .end = at(t, f.to)};
  if (open) c->unit_begin = at(t, open + 1);
  if (open) c->unit_end = at(t, f.to - 1);
  c->name = strndup(name.from, (size_t)(name.to - name.from));
  return true;
}

static bool has_names(const text_table *t, const char *line) {
  double value;
  for (const char *p = line, *end = line_end(line); p;)
    if (!as_number(read_field(t, p, end, &p), &value)) return true;
  return false;
}

/* The columns that the first line has. */
static bool read_titles(text_table *t, const char *line, bool named, diagnostics *d) {
  t->columns = must_calloc((size_t)fields_in(t, line), sizeof *t->columns);
  for (const char *p = line, *end = line_end(line); p; t->column_count++) {
    const field f = read_field(t, p, end, &p);
    text_column *c = &t->columns[t->column_count];
    *c = (text_column){.begin = at(t, f.from), .end = at(t, f.to)};
    if (!named)
      c->name = strdup("");
    else if (!read_title(t, f, c, d))
      return false;
  }
  return true;
}

/* A deck may come from somebody else, and name a file whose lines are nobody's business: messages
   show none of a file without numbers. */
static bool is_table(const text_table *t, const char *row, span where, diagnostics *d) {
  double value;
  if (!row && t->separator != ' ') return true; /* names of columns, and nothing below */
  for (const char *p = row, *end = row ? line_end(row) : NULL; p;)
    if (as_number(read_field(t, p, end, &p), &value)) return true;
  diag_report(d, DIAG_FILE, where, "`%s` is not a table", t->file.path);
  diag_hint(d,
            "its first line names the columns, e.g. time [ms], F [kN]; those below hold numbers");
  return false;
}

bool text_table_read(text_table *t, char *path, span where, diagnostics *d) {
  *t = (text_table){.rows = 0};
  if (!file_text_open(&t->file, path, where, d)) return false;
  if (strlen(t->file.text) != t->file.length)
    return file_text_refuse(&t->file, where, d, "it is not a text");
  const bool marked = t->file.length >= 3 && memcmp(t->file.text, "\xef\xbb\xbf", 3) == 0;
  const char *line = find_line(t, t->file.text + (marked ? 3 : 0));
  if (!line) return true;
  t->header = at(t, line);
  t->separator = separator_of(line);
  const bool named = has_names(t, line);
  const char *row = named ? find_line(t, line_after(t, line)) : line;
  return is_table(t, row, where, d) && read_titles(t, line, named, d) && find_rows(t, row, d);
}

void text_table_free(text_table *t) {
  for (int k = 0; k < t->column_count; k++)
    free(t->columns[k].name);
  free(t->columns);
  free(t->begin);
  file_text_close(&t->file);
}

/* --- finding a column ------------------------------------------------------------------------- */

static int numbered(const text_table *t, const char *name) {
  char *rest;
  const long number = isdigit((unsigned char)*name) ? strtol(name, &rest, 10) : 0;
  return number >= 1 && number <= t->column_count && !*rest ? (int)number - 1 : TEXT_TABLE_NONE;
}

int text_table_find(text_table *t, const char *name, diagnostics *d) {
  int found = TEXT_TABLE_NONE;
  for (int k = 0; k < t->column_count; k++) {
    if (!*name || strcasecmp(t->columns[k].name, name) != 0) continue;
    if (found >= 0) {
      diag_report(d, DIAG_DUPLICATE_NAME, text_table_title(t, k, d),
                  "there is a second column `%s`", t->columns[found].name);
      return TEXT_TABLE_TWO;
    }
    found = k;
  }
  return found >= 0 ? found : numbered(t, name);
}

/* "`cmod`, `load_low`"; of a table without names "1 to 3". */
static void list_columns(const text_table *t, char *words, size_t size) {
  size_t used = 0;
  if (t->column_count && !*t->columns[0].name) snprintf(words, size, "1 to %d", t->column_count);
  if (t->column_count && !*t->columns[0].name) return;
  words[0] = 0;
  for (int k = 0; k < t->column_count && used < size; k++)
    used +=
        (size_t)snprintf(words + used, size - used, "%s`%s`", k ? ", " : "", t->columns[k].name);
}

int text_table_column(text_table *t, const char *name, span where, diagnostics *d) {
  char words[WORDS_LENGTH];
  const int column = text_table_find(t, name, d);
  if (column != TEXT_TABLE_NONE) return column;
  diag_report(d, DIAG_UNKNOWN_NAME, where, "`%s` has no column `%s`", t->file.path, name);
  list_columns(t, words, sizeof words);
  if (t->column_count) diag_hint(d, "its columns are %s", words);
  return column;
}

/* --- values ----------------------------------------------------------------------------------- */

bool text_table_has_unit(const text_table *t, int column) {
  return t->columns[column].unit_end > t->columns[column].unit_begin;
}

bool text_table_unit(text_table *t, int column, unit *u, diagnostics *d) {
  const text_column *c = &t->columns[column];
  const char *from = t->file.text + c->unit_begin, *bad;
  const size_t length = c->unit_end - c->unit_begin;
  size_t bad_length;
  *u = (unit){.dim = DIMENSIONLESS, .factor = 1};
  if (length == 0 || (length == 1 && *from == '-')) return true;
  if (unit_parse(from, length, u, &bad, &bad_length)) return true;
  diag_report(d, DIAG_UNKNOWN_UNIT, file_text_span(&t->file, from, from + length, d),
              "there is no unit `%.*s`", (int)pl_fmin((double)bad_length, 40), bad);
  unit_hint(d, bad, bad_length);
  return false;
}

/* A plain number is one of SI. */
static bool unit_fits(text_table *t, int column, const char *si_unit, double *factor,
                      diagnostics *d) {
  unit given, needed;
  const char *bad;
  size_t bad_length;
  if (!text_table_unit(t, column, &given, d)) return false;
  unit_parse(si_unit, strlen(si_unit), &needed, &bad, &bad_length);
  *factor = given.factor;
  if (!text_table_has_unit(t, column) || dim_equal(given.dim, needed.dim)) return true;
  const text_column *c = &t->columns[column];
  diag_report(d, DIAG_UNITS,
              file_text_span(&t->file, t->file.text + c->unit_begin, t->file.text + c->unit_end, d),
              "the unit of `%s` is one of `%s`", c->name, si_unit);
  return false;
}

/* How messages call a column. */
static const char *name_of(const text_table *t, int column, char words[WORDS_LENGTH]) {
  if (*t->columns[column].name)
    snprintf(words, WORDS_LENGTH, "`%s`", t->columns[column].name);
  else
    snprintf(words, WORDS_LENGTH, "column %d", column + 1);
  return words;
}

static bool read_number(text_table *t, long row, int column, double factor, double *value,
                        diagnostics *d) {
  const field f = cell_of(t, row, column);
  char words[WORDS_LENGTH];
  const bool number = as_number(f, value);
  *value *= factor;
  if (number && isfinite(*value)) return true;
  const span where = file_text_span(&t->file, f.from, f.to, d);
  name_of(t, column, words);
  if (f.from == f.to) {
    diag_report(d, DIAG_BAD_VALUE, where, "here is no value of %s", words);
  } else if (number) {
    diag_report(d, DIAG_BAD_NUMBER, where, "%s is not finite here", words);
  } else {
    diag_report(d, DIAG_BAD_NUMBER, where, "%s is not a number here", words);
    if (memchr(f.from, ',', (size_t)(f.to - f.from)))
      diag_hint(d, "decimals are written with a point, not a comma");
  }
  return false;
}

double *text_table_values(text_table *t, int column, const char *si_unit, bool gaps,
                          diagnostics *d) {
  double factor, *values = must_alloc(((size_t)t->rows + 1) * sizeof *values);
  bool good = unit_fits(t, column, si_unit, &factor, d);
  for (long row = 0; good && row < t->rows; row++) {
    const field f = cell_of(t, row, column);
    values[row] = NAN;
    if (f.from < f.to || !gaps) good = read_number(t, row, column, factor, &values[row], d);
  }
  if (good) return values;
  free(values);
  return NULL;
}

/* --- places ----------------------------------------------------------------------------------- */

span text_table_header(text_table *t, diagnostics *d) {
  return line_span(t, t->file.text + t->header, d);
}

span text_table_title(text_table *t, int column, diagnostics *d) {
  const text_column *c = &t->columns[column];
  return file_text_span(&t->file, t->file.text + c->begin, t->file.text + c->end, d);
}

span text_table_line(text_table *t, long row, diagnostics *d) {
  return line_span(t, t->file.text + t->begin[row], d);
}

span text_table_cell(text_table *t, long row, int column, diagnostics *d) {
  const field f = cell_of(t, row, column);
  return file_text_span(&t->file, f.from, f.to, d);
}

long text_table_line_number(const text_table *t, long row) {
  long line = 1;
  for (const char *p = t->file.text; p < t->file.text + t->begin[row]; p++)
    line += *p == '\n';
  return line;
}

/* --- files with columns ----------------------------------------------------------------------- */

/* The colon behind an ending like `.csv`; NULL without one. */
static const char *find_colon(const char *given) {
  for (const char *colon = strchr(given, ':'); colon; colon = strchr(colon + 1, ':')) {
    const char *p = colon;
    while (p > given && isalnum((unsigned char)p[-1]))
      p--;
    if (p < colon && p > given + 1 && p[-1] == '.') return colon;
  }
  return NULL;
}

char *text_table_split(const char *given, const char **columns) {
  const char *colon = find_colon(given);
  *columns = colon ? colon + 1 : NULL;
  return colon ? strndup(given, (size_t)(colon - given)) : strdup(given);
}

int text_table_names(const char *columns, char **names, int most) {
  int count = 0;
  for (const char *p = columns; p; count++) {
    const char *comma = strchr(p, ',');
    const field f = trimmed(p, comma ? comma : p + strlen(p));
    if (count < most) names[count] = strndup(f.from, (size_t)(f.to - f.from));
    p = comma ? comma + 1 : NULL;
  }
  return count;
}
