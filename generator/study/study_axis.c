#include "generator/study/study_axis.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "runtime/base/namelist.h"

typedef struct piece { /* of a given text, without blanks around it */
  const char *text;    /* in the arena */
  span where;
} piece;

static piece piece_of(arena *a, const study_text *given, size_t begin, size_t end) {
  const char *text = given->text;
  while (begin < end && isspace((unsigned char)text[begin]))
    begin++;
  while (end > begin && isspace((unsigned char)text[end - 1]))
    end--;
  const uint32_t at = given->where.begin;
  return (piece){arena_text(a, text + begin, end - begin),
                 {at + (uint32_t)begin, at + (uint32_t)end, given->where.file}};
}

bool study_split_number(const char *text, double *number, const char **unit_text) {
  const size_t used = namelist_number(text, strlen(text), number);
  const char *rest = text + used;
  while (isspace((unsigned char)*rest))
    rest++;
  *unit_text = rest;
  return used > 0 && isfinite(*number);
}

const char *study_value_text(arena *a, double number, const char *unit_text) {
  return arena_printf(a, "%.12g%s%s", number, *unit_text ? " " : "", unit_text);
}

/* --- key and values --------------------------------------------------------------------------- */

static bool wrong_form(diagnostics *d, span where, const char *example) {
  diag_report(d, DIAG_DECK_SYNTAX, where, "what is varied has the form group.key=values");
  diag_hint(d, "e.g. \"%s\"", example);
  return false;
}

static const char vary_example[] = "lattice.spacing=20, 10, 5 mm";

/* The name before the equals sign. */
static bool read_name(arena *a, const study_text *given, size_t begin, size_t end, study_key *key,
                      diagnostics *d) {
  const piece name = piece_of(a, given, begin, end);
  const char *dot = strrchr(name.text, '.'), *bracket = strrchr(name.text, ']');
  if (bracket && (!dot || dot < bracket)) dot = bracket[1] == '.' ? bracket + 1 : NULL;
  if (!dot || dot == name.text || !dot[1]) return wrong_form(d, name.where, vary_example);
  key->name = name.text;
  key->shown = dot + 1;
  key->where = name.where;
  return true;
}

static size_t find(const char *text, size_t begin, size_t end, const char *word) {
  const size_t length = strlen(word);
  for (size_t k = begin; k + length <= end; k++)
    if (strncmp(text + k, word, length) == 0) return k;
  return end;
}

/* Numbers before the last one that have no unit get its. */
static void share_unit(arena *a, const char **values, int count) {
  double number;
  const char *last, *own;
  if (count < 2 || !study_split_number(values[count - 1], &number, &last) || !*last) return;
  for (int k = 0; k < count - 1; k++)
    if (study_split_number(values[k], &number, &own) && !*own)
      values[k] = arena_printf(a, "%s %s", values[k], last);
}

/* Two or three numbers between colons, as other languages write ranges; the rest is a unit. */
static int colon_numbers(const char *text, double number[3], const char **rest) {
  int count = 0;
  while (count < 3) {
    const size_t used = namelist_number(text, strlen(text), &number[count]);
    if (used == 0) return 0;
    count++;
    text += used;
    if (*text != ':') break;
    text++;
  }
  while (isspace((unsigned char)*text))
    text++;
  *rest = text;
  return count;
}

static bool is_range_without_dots(const char *text) {
  double number[3];
  const char *rest = "";
  return colon_numbers(text, number, &rest) > 1 && !strchr(rest, ':');
}

/* "from:step:to", or "from:to:step" where no such step leads there. */
static const char *range_meant(arena *a, const char *text) {
  double n[3];
  const char *rest = "";
  const int count = colon_numbers(text, n, &rest);
  const char *space = *rest ? " " : "";
  if (count < 3) return arena_printf(a, "%.12g..%.12g:STEP%s%s", n[0], n[1], space, rest);
  const bool step_last = fabs(n[1]) > fabs(n[2] - n[0]);
  return arena_printf(a, "%.12g..%.12g:%.12g%s%s", n[0], n[step_last ? 1 : 2], n[step_last ? 2 : 1],
                      space, rest);
}

static void take_value(arena *a, study_key *key, int *count, const char *value, span where) {
  key->values = arena_room(a, key->values, *count, sizeof *key->values);
  key->places = arena_room(a, key->places, *count, sizeof *key->places);
  key->values[*count] = value;
  key->places[(*count)++] = where;
}

static bool add_value(arena *a, study_key *key, int *count, piece value, diagnostics *d) {
  if (!*value.text) {
    diag_report(d, DIAG_BAD_VALUE, value.where, "there is a value missing here");
    return false;
  }
  if (is_range_without_dots(value.text)) {
    diag_report(d, DIAG_BAD_VALUE, value.where, "`%s` is no number", value.text);
    diag_hint(d, "a range is from..to:step: `%s`", range_meant(a, value.text));
    return false;
  }
  take_value(a, key, count, value.text, value.where);
  return true;
}

/* Without the number of the first one. */
static size_t without_first(const char *name, char *text, size_t size) {
  const char *first = strstr(name, "[1].");
  return (size_t)(first ? snprintf(text, size, "%.*s%s", (int)(first - name), name, first + 3)
                        : snprintf(text, size, "%s", name));
}

bool study_same_key(const char *a, const char *b) {
  char texts[2][400];
  return without_first(a, texts[0], sizeof texts[0]) < sizeof texts[0] &&
         without_first(b, texts[1], sizeof texts[1]) < sizeof texts[1] &&
         strcasecmp(texts[0], texts[1]) == 0;
}

bool study_key_is(const study_key *key, const char *given) {
  return strcasecmp(key->name, given) == 0 || strcasecmp(key->shown, given) == 0;
}

/* --- ranges ----------------------------------------------------------------------------------- */

/* low..high[:step], the unit of the last shared. */
static bool read_ends(arena *a, const study_text *given, size_t begin, size_t end, study_range *r,
                      diagnostics *d) {
  const size_t dots = find(given->text, begin, end, "..");
  const size_t colon = find(given->text, dots, end, ":");
  const char *ends[3] = {piece_of(a, given, begin, dots).text,
                         piece_of(a, given, dots + 2, colon).text,
                         colon < end ? piece_of(a, given, colon + 1, end).text : ""};
  const int count = colon < end ? 3 : 2;
  for (int k = 0; k < count; k++) {
    double number;
    const char *rest;
    if (study_split_number(ends[k], &number, &rest)) continue;
    diag_report(d, DIAG_BAD_VALUE, piece_of(a, given, begin, end).where,
                "`%s` is no range of numbers", piece_of(a, given, begin, end).text);
    diag_hint(d, "low..high, or from..to:step, e.g. 40..60:5 kN");
    return false;
  }
  share_unit(a, ends, count);
  r->low = ends[0];
  r->high = ends[1];
  r->step = count == 3 ? ends[2] : NULL;
  return true;
}

/* The numbers of low, high and step, which must be in one unit. */
static bool range_numbers(const study_range *r, double number[3], const char **unit_text) {
  const char *texts[] = {r->low, r->high, r->step};
  const char *other;
  for (int k = 0; k < 3; k++) {
    if (!study_split_number(texts[k], &number[k], k ? &other : unit_text)) return false;
    if (k && strcmp(other, *unit_text) != 0) return false;
  }
  return true;
}

static bool count_up(arena *a, const study_range *r, span where, study_key *key, int *count,
                     diagnostics *d) {
  double n[3];
  const char *unit_text;
  if (!r->step) {
    diag_report(d, DIAG_BAD_VALUE, where, "a range that is varied needs a step");
    diag_hint(d, "from..to:step, e.g. 40..60:5 kN");
    return false;
  }
  if (!range_numbers(r, n, &unit_text)) {
    diag_report(d, DIAG_BAD_VALUE, where, "from, to and step of a range have one unit");
    diag_hint(d, "write it once, at the end: 40..60:5 kN");
    return false;
  }
  const double step = copysign(n[2], n[1] - n[0]), steps = n[2] != 0 ? (n[1] - n[0]) / step : -1;
  if (!(steps >= 0 && steps < STUDY_MOST_VALUES)) {
    diag_report(d, DIAG_BAD_VALUE, where, "this range has %s values",
                steps >= 0 ? "too many" : "no");
    return false;
  }
  for (int k = 0; k <= (int)(steps + 1e-9); k++)
    take_value(a, key, count, study_value_text(a, n[0] + k * step, unit_text), where);
  return true;
}

bool study_range_read(arena *a, const study_text *given, study_range *range, diagnostics *d) {
  const size_t end = strlen(given->text), equals = find(given->text, 0, end, "=");
  *range = (study_range){.low = NULL};
  if (!read_name(a, given, 0, equals, &range->key, d)) return false;
  if (equals == end) return true;
  if (find(given->text, equals, end, "..") < end)
    return read_ends(a, given, equals + 1, end, range, d);
  range->low = piece_of(a, given, equals + 1, end).text;
  return true;
}

/* --- axes ------------------------------------------------------------------------------------- */

static bool read_values(arena *a, const study_text *given, size_t begin, size_t end, study_key *key,
                        int *count, diagnostics *d) {
  const char *text = given->text;
  *count = 0;
  const piece first = piece_of(a, given, begin, find(text, begin, end, ".."));
  double number;
  const char *rest;
  if (find(text, begin, end, "..") < end && study_split_number(first.text, &number, &rest)) {
    study_range r = {.low = NULL};
    return read_ends(a, given, begin, end, &r, d) &&
           count_up(a, &r, piece_of(a, given, begin, end).where, key, count, d);
  }
  const char *separator = find(text, begin, end, ";") < end ? ";" : ",";
  for (size_t at = begin; at <= end;) {
    const size_t next = find(text, at, end, separator);
    if (*count == STUDY_MOST_VALUES) {
      diag_report(d, DIAG_TOO_LONG, given->where, "more than %d values", STUDY_MOST_VALUES);
      return false;
    }
    if (!add_value(a, key, count, piece_of(a, given, at, next), d)) return false;
    at = next + 1;
  }
  if (*separator == ',') share_unit(a, key->values, *count);
  return true;
}

/* One key with its values, between begin and end. */
static bool read_key(arena *a, const study_text *given, size_t begin, size_t end, study_axis *axis,
                     diagnostics *d) {
  const size_t equals = find(given->text, begin, end, "=");
  study_key key = {.values = NULL};
  int count;
  if (equals == end) return wrong_form(d, piece_of(a, given, begin, end).where, vary_example);
  if (!read_name(a, given, begin, equals, &key, d) ||
      !read_values(a, given, equals + 1, end, &key, &count, d))
    return false;
  if (axis->key_count && count != axis->count) {
    diag_report(d, DIAG_BAD_VALUE, key.where, "`%s` has %d value%s, but `%s` has %d", key.name,
                count, count == 1 ? "" : "s", axis->keys[0].name, axis->count);
    diag_hint(d, "keys that change together have as many values");
    return false;
  }
  axis->count = count;
  axis->keys = arena_room(a, axis->keys, axis->key_count, sizeof *axis->keys);
  axis->keys[axis->key_count++] = key;
  return true;
}

bool study_axis_read(arena *a, const study_text *given, study_axis *axis, diagnostics *d) {
  static const char with[] = " with ";
  const size_t end = strlen(given->text);
  *axis = (study_axis){.where = given->where};
  for (size_t at = 0; at <= end;) {
    const size_t next = find(given->text, at, end, with);
    if (!read_key(a, given, at, next, axis, d)) return false;
    at = next < end ? next + strlen(with) : end + 1;
  }
  return true;
}
