#include "dsl/base/diagnostics.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/arena.h"
#include "dsl/base/quote.h"
#include "dsl/base/terminal.h"

enum { NAME_LENGTH = 64 };

/* Nobody reads more than this at once. */
enum { MOST_PRINTED = 100 };

static const struct {
  const char *name;
  severity severity;
} codes[DIAG_COUNT] = {
#define X(code, name, severity) {name, severity},
#include "dsl/base/diagnostic_codes.h"
#undef X
};

const char *diag_name(diag_code code) {
  return codes[code].name;
}
severity diag_severity(diag_code code) {
  return codes[code].severity;
}

static char *format_text(const char *format, va_list values) {
  va_list again;
  va_copy(again, values);
  int length = vsnprintf(NULL, 0, format, values);
  char *text = must_calloc(length < 0 ? 1 : (size_t)length + 1, 1);
  if (length >= 0) vsnprintf(text, (size_t)length + 1, format, again);
  va_end(again);
  return text;
}

void diag_begin(diagnostics *d, source_set *sources) {
  *d = (diagnostics){.sources = sources};
}

static void clear_list(diagnostic *items, int count) {
  for (int i = 0; i < count; i++) {
    free(items[i].message);
    free(items[i].note);
    free(items[i].hint);
  }
  free(items);
}

void diag_clear(diagnostics *d) {
  clear_list(d->items, d->count);
  clear_list(d->accepted, d->accepted_count);
  *d = (diagnostics){.sources = d->sources};
}

/* Room is the power of two at or above the count. */
static void append(diagnostic **items, int *count, diagnostic one) {
  if ((*count & (*count - 1)) == 0)
    *items = must_realloc(*items, (*count ? 2 * (size_t)*count : 1) * sizeof **items);
  (*items)[(*count)++] = one;
}

static void report(diagnostics *d, diag_code code, span where, const char *format, va_list values) {
  char *message = format_text(format, values);
  append(&d->items, &d->count, (diagnostic){.code = code, .where = where, .message = message});
  if (diag_severity(code) == SEVERITY_ERROR) d->errors++;
}

void diag_report(diagnostics *d, diag_code code, span where, const char *format, ...) {
  va_list values;
  va_start(values, format);
  report(d, code, where, format, values);
  va_end(values);
}

bool diag_report_once(diagnostics *d, bool said[DIAG_COUNT], diag_code code, span where,
                      const char *format, va_list values) {
  if (said[code]) return false;
  said[code] = true;
  report(d, code, where, format, values);
  return true;
}

/* The compiler's own faults (`tangent`) are none of a law's. */
bool diag_may_be_accepted(diag_code code) {
  return code == DIAG_DAMAGE_RANGE || code == DIAG_DIVISION_BY_ZERO || code == DIAG_DOMAIN ||
         (code >= DIAG_EXCHANGE && code <= DIAG_STRESS_STATE && code != DIAG_TANGENT);
}

void diag_accept(diagnostics *d, int k, const char *why) {
  diagnostic one = d->items[k];
  one.accepted = why;
  if (diag_severity(one.code) == SEVERITY_ERROR) d->errors--;
  memmove(&d->items[k], &d->items[k + 1], (size_t)(d->count - k - 1) * sizeof *d->items);
  d->count--;
  append(&d->accepted, &d->accepted_count, one);
}

void diag_note(diagnostics *d, span where, const char *format, ...) {
  if (!d->count) return;
  va_list values;
  va_start(values, format);
  diagnostic *last = &d->items[d->count - 1];
  free(last->note);
  last->note = format_text(format, values);
  last->note_where = where;
  va_end(values);
}

void diag_hint(diagnostics *d, const char *format, ...) {
  if (!d->count) return;
  va_list values;
  va_start(values, format);
  diagnostic *last = &d->items[d->count - 1];
  free(last->hint);
  last->hint = format_text(format, values);
  va_end(values);
}

bool diag_hinted(const diagnostics *d) {
  return d->count > 0 && d->items[d->count - 1].hint;
}

void diag_suggest(diagnostics *d, const char *name, const char *const *candidates, int count) {
  const char *nearest = nearest_name(name, candidates, count);
  if (nearest) diag_hint(d, "did you mean `%s`?", nearest);
}

/* --- nearest name ----------------------------------------------------------------------------- */

static int least(int a, int b) {
  return a < b ? a : b;
}

/* Changes, insertions, deletions and swaps of neighbours that turn a into b. */
static int edit_distance(const char *a, const char *b) {
  int length_a = (int)strlen(a), length_b = (int)strlen(b);
  int rows[3][NAME_LENGTH + 1];
  int *before = rows[0], *last = rows[1], *now = rows[2];
  for (int j = 0; j <= length_b; j++)
    last[j] = j;
  for (int i = 1; i <= length_a; i++) {
    now[0] = i;
    for (int j = 1; j <= length_b; j++) {
      int change = last[j - 1] + (a[i - 1] != b[j - 1]);
      now[j] = least(change, least(last[j], now[j - 1]) + 1);
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        now[j] = least(now[j], before[j - 2] + 1);
    }
    int *oldest = before;
    before = last;
    last = now;
    now = oldest;
  }
  return last[length_b];
}

const char *nearest_name(const char *name, const char *const *candidates, int count) {
  size_t length = strlen(name);
  if (length == 0 || length > NAME_LENGTH) return NULL;
  for (int i = 0; i < count; i++)
    if (strcasecmp(name, candidates[i]) == 0) return candidates[i];
  const char *nearest = NULL;
  int nearest_distance = length < 2 ? 0 : (int)(length + 2) / 3;
  for (int i = 0; i < count; i++) {
    if (strlen(candidates[i]) > NAME_LENGTH || strlen(candidates[i]) < 2) continue;
    int distance = edit_distance(name, candidates[i]);
    if (distance > nearest_distance || (nearest && distance == nearest_distance)) continue;
    nearest = candidates[i];
    nearest_distance = distance;
  }
  return nearest;
}

/* --- printing --------------------------------------------------------------------------------- */

static bool mentioned[DIAG_COUNT]; /* codes that have been printed */

static bool located(const diagnostics *d, span where) {
  return d->sources && where.file < d->sources->count;
}

static void print_painted(FILE *out, terminal_paint paint, const char *text) {
  terminal_paint_with(out, paint);
  fputs(text, out);
  terminal_paint_with(out, PAINT_PLAIN);
}

static void print_place(const diagnostics *d, span where, FILE *out) {
  const place at = source_place(d->sources, where.file, where.begin);
  terminal_paint_with(out, PAINT_PLACE);
  fprintf(out, "%s:%d:%d: ", d->sources->items[where.file].name, at.line, at.column);
  terminal_paint_with(out, PAINT_PLAIN);
}

static const struct {
  const char *word;
  terminal_paint paint;
} kinds[] = {{"error", PAINT_ERROR},
             {"warning", PAINT_WARNING},
             {"note", PAINT_NOTE},
             {"accepted", PAINT_NOTE}};
enum { NOTE = SEVERITY_WARNING + 1, ACCEPTED };

static void print_one(const diagnostics *d, span where, int kind, const char *message,
                      const char *name, FILE *out) {
  const bool here = located(d, where);
  if (here) print_place(d, where, out);
  print_painted(out, kinds[kind].paint, kinds[kind].word);
  fprintf(out, ": %s", message);
  if (name) fprintf(out, " [%s]", name);
  fputc('\n', out);
  if (here) quote_line(d->sources, where, out);
}

static int by_place(const void *a, const void *b) {
  const diagnostic *x = *(const diagnostic *const *)a, *y = *(const diagnostic *const *)b;
  if (x->where.file != y->where.file) return x->where.file < y->where.file ? -1 : 1;
  if (x->where.begin != y->where.begin) return x->where.begin < y->where.begin ? -1 : 1;
  return x < y ? -1 : x > y; /* as reported: both lie in one array */
}

const diagnostic **diag_sorted(const diagnostics *d) {
  const diagnostic **order = must_calloc((size_t)d->count + 1, sizeof(*order));
  for (int i = 0; i < d->count; i++)
    order[i] = &d->items[i];
  qsort(order, (size_t)d->count, sizeof(*order), by_place);
  return order;
}

void diag_print(const diagnostics *d, FILE *out) {
  const diagnostic **order = diag_sorted(d);
  for (int i = 0; i < d->count && i < MOST_PRINTED; i++) {
    const diagnostic *one = order[i];
    mentioned[one->code] = true;
    print_one(d, one->where, (int)diag_severity(one->code), one->message, diag_name(one->code),
              out);
    if (one->hint) {
      print_painted(out, PAINT_NOTE, "  hint");
      fprintf(out, ": %s\n", one->hint);
    }
    if (one->note) print_one(d, one->note_where, NOTE, one->note, NULL, out);
  }
  if (d->count > MOST_PRINTED) fprintf(out, "and %d more like these\n", d->count - MOST_PRINTED);
  free(order);
  for (int i = 0; i < d->accepted_count; i++) {
    const diagnostic *one = &d->accepted[i];
    print_one(d, one->where, ACCEPTED, one->message, diag_name(one->code), out);
    print_painted(out, PAINT_NOTE, "  because");
    fprintf(out, ": %s\n", one->accepted);
  }
}

void diag_print_topics(FILE *out) {
  int count = 0;
  for (int k = 0; k < DIAG_COUNT; k++) {
    if (!mentioned[k]) continue;
    fprintf(out, "%s %s", count++ ? "" : "`perilat help", diag_name((diag_code)k));
    mentioned[k] = false;
  }
  if (count) fprintf(out, "` says more about %s\n", count > 1 ? "these messages" : "this message");
}
