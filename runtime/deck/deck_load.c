#include "runtime/deck/deck_load.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/base/text_table.h"
#include "runtime/deck/deck_formula.h"

enum { FROM_FILE = TIME_FORMULA + 1, WAYS };

static const char *const way_words[WAYS] = {"a constant load",    "a ramp",  "a ramp and hold",
                                            "a cosine",           "a table", "a formula",
                                            "a table from a file"};

enum {
  RISING = 1 << TIME_RAMP | 1 << TIME_RAMP_HOLD | 1 << TIME_COSINE,
  TABULATED = 1 << TIME_TABLE
};
static const deck_key_use uses[] = {{"rise", RISING, true},
                                    {"times", TABULATED, true},
                                    {"values", TABULATED, true},
                                    {"file", 1 << FROM_FILE, true},
                                    {"formula", 1 << TIME_FORMULA, true}};

/* The shape, FROM_FILE for a table that stands in a file; -1 after a message. */
static int way_of(arena *a, const namelist_group *g, const deck_load_kind *kind, diagnostics *d) {
  const namelist_key *history = namelist_find(g, "history");
  int way = TIME_CONSTANT;
  if (history)
    way = deck_choice_read(a, history, kind->knows ? DECK_HISTORIES : DECK_HISTORIES_AS_TABLES, d);
  else if (namelist_find(g, "formula"))
    way = TIME_FORMULA;
  else if (namelist_find(g, "rise"))
    way = TIME_RAMP_HOLD;
  else if (namelist_find(g, "times") || namelist_find(g, "values") || namelist_find(g, "file"))
    way = TIME_TABLE;
  if (way == TIME_TABLE && namelist_find(g, "file")) way = FROM_FILE;
  return way >= 0 && deck_keys_fit(g, uses, sizeof uses / sizeof *uses, way, way_words[way], d)
             ? way
             : -1;
}

static bool read_time(const namelist_group *g, const char *name, deck_bound bound, double *time,
                      diagnostics *d) {
  const namelist_key *key = namelist_find(g, name);
  if (!key) return true;
  return deck_values_counted(key, 1, d) &&
         deck_real_read(&key->values[0], name, "s", bound, time, d);
}

static bool ends_later(const namelist_group *g, const time_function *f, diagnostics *d) {
  if (time_function_end(f) > f->start) return true;
  diag_report(d, DIAG_OUT_OF_BOUNDS, namelist_find(g, "end")->value_where,
              "`end` must be later than `start`");
  return false;
}

static double *read_list(arena *a, const namelist_key *key, const char *name, const char *unit_text,
                         diagnostics *d) {
  double *list = arena_alloc(a, (size_t)key->value_count * sizeof(double));
  for (int i = 0; i < key->value_count; i++)
    if (!deck_real_read(&key->values[i], name, unit_text, BOUND_NONE, &list[i], d)) return NULL;
  return list;
}

static bool check_times(const namelist_key *key, const double *times, diagnostics *d) {
  if (key->value_count < 2) {
    diag_report(d, DIAG_BAD_VALUE, key->value_where, "a table has at least two points");
    return false;
  }
  for (int i = 0; i < key->value_count; i++) {
    if (i == 0 ? times[i] >= 0 : times[i] > times[i - 1]) continue;
    diag_report(d, DIAG_OUT_OF_BOUNDS, key->values[i].where,
                i == 0 ? "`times` must not be negative"
                       : "each of the `times` must be later than the one before");
    return false;
  }
  return true;
}

static bool as_many(const namelist_key *times, const namelist_key *values, diagnostics *d) {
  if (times->value_count == values->value_count) return true;
  diag_report(d, DIAG_BAD_VALUE, values->value_where,
              "`times` and `values` must be equally many, but they are %d and %d",
              times->value_count, values->value_count);
  diag_note(d, times->value_where, "the times");
  return false;
}

/* Takes over values of the load itself. */
static void set_table(arena *a, const double *times, double *values, int count, time_function *f) {
  double *integrals = arena_alloc(a, (size_t)count * sizeof *integrals);
  time_table_integrals(times, values, count, integrals);
  f->times = times;
  f->values = values;
  f->integrals = integrals;
  f->count = count;
}

static bool report_large(span where, diagnostics *d) {
  diag_report(d, DIAG_BAD_NUMBER, where, "the value is too large");
  return false;
}

/* The table's factors times the full value: the function then needs no other. */
static bool read_table(arena *a, const namelist_group *g, double full, time_function *f,
                       diagnostics *d) {
  const namelist_key *times = namelist_find(g, "times"), *values = namelist_find(g, "values");
  double *t = read_list(a, times, "times", "s", d);
  double *v = t ? read_list(a, values, "values", "1", d) : NULL;
  if (!v) {
    if (d->items[d->count - 1].code == DIAG_UNITS && t)
      diag_hint(d, "`values` are factors on the full value");
    return false;
  }
  if (!check_times(times, t, d) || !as_many(times, values, d)) return false;
  for (int i = 0; i < values->value_count; i++) {
    v[i] *= full;
    if (!isfinite(v[i])) return report_large(values->values[i].where, d);
  }
  set_table(a, t, v, times->value_count, f);
  return true;
}

/* --- a table from a file ---------------------------------------------------------------------- */

enum { TIME, VALUE, PAIR };

typedef struct load_file {
  text_table text;
  int column[PAIR];       /* of time and value */
  const char *key, *what; /* "file", "a load" */
} load_file;

static bool report_columns(const load_file *l, span where, diagnostics *d) {
  diag_report(d, DIAG_BAD_VALUE, where, "`%s` has %d column%s; %s has two, time and value",
              l->text.file.path, l->text.column_count, l->text.column_count == 1 ? "" : "s",
              l->what);
  if (l->text.column_count > PAIR)
    diag_hint(d, "say which, by names or numbers: %s = 'FILE:%s,%s'", l->key,
              *l->text.columns[0].name ? l->text.columns[0].name : "1",
              *l->text.columns[1].name ? l->text.columns[1].name : "2");
  return false;
}

static bool choose_columns(load_file *l, const char *columns, span where, diagnostics *d) {
  char *names[PAIR] = {NULL, NULL};
  bool good =
      columns ? text_table_names(columns, names, PAIR) == PAIR : l->text.column_count == PAIR;
  if (!good && columns)
    diag_report(d, DIAG_BAD_VALUE, where, "%s has two columns, time and value: FILE:TIME,VALUE",
                l->what);
  if (!good && !columns) report_columns(l, where, d);
  for (int c = 0; c < PAIR; c++) {
    if (good) l->column[c] = columns ? text_table_column(&l->text, names[c], where, d) : c;
    good = good && l->column[c] >= 0;
    free(names[c]);
  }
  return good;
}

/* Its text stays among the sources. To be freed in either case. */
static bool open_file(load_file *l, const namelist_group *g, const char *name_of_key,
                      diagnostics *d) {
  const namelist_key *key = namelist_find(g, name_of_key);
  const char *columns;
  *l = (load_file){.key = name_of_key,
                   .what = strcmp(name_of_key, "file") == 0 ? "a load" : "a table in time"};
  if (!deck_values_counted(key, 1, d)) return false;
  const namelist_value *v = &key->values[0];
  if (v->kind != NAMELIST_TEXT || !*v->text) {
    diag_report(d, DIAG_BAD_VALUE, v->where, "`%s` is the name of a table in quotes", name_of_key);
    return false;
  }
  char *name = text_table_split(v->text, &columns);
  char *path = deck_file_path(d->sources->items[g->where.file].name, name);
  free(name);
  if (!text_table_read(&l->text, path, v->where, d)) return false;
  file_text_source(&l->text.file, d);
  return choose_columns(l, columns, v->where, d);
}

static const char *name_of(const load_file *l, int c) {
  const char *name = l->text.columns[l->column[c]].name;
  return *name ? name : c == TIME ? "time" : "value";
}

/* Factors have no unit, loads have theirs. */
static bool unit_suits(load_file *l, const namelist_key *full, const deck_load_kind *kind,
                       diagnostics *d) {
  unit given;
  const bool has_unit = text_table_has_unit(&l->text, l->column[VALUE]);
  if (!text_table_unit(&l->text, l->column[VALUE], &given, d)) return false;
  if (full && !dim_is_none(given.dim)) {
    diag_report(d, DIAG_CONFLICT, text_table_title(&l->text, l->column[VALUE], d),
                "with `%s` in the deck `%s` holds factors on it, which have no unit", full->name,
                name_of(l, VALUE));
    diag_note(d, full->name_where, "`%s` is given here", full->name);
    diag_hint(d, "leave `%s` out where the column is the load itself", full->name);
  } else if (!full && !has_unit && !kind->implied) {
    diag_report(d, DIAG_MISSING_KEY, text_table_title(&l->text, l->column[VALUE], d),
                "`%s` has no unit: it is a load with one, or a factor on `%s`, which the deck does "
                "not give",
                name_of(l, VALUE), kind->key);
    diag_hint(d, "write `%s [%s]`, or give `%s`", name_of(l, VALUE), kind->unit, kind->key);
  } else {
    return true;
  }
  return false;
}

static bool times_ascend(load_file *l, const double *t, diagnostics *d) {
  if (l->text.rows < 2) {
    diag_report(d, DIAG_BAD_VALUE, text_table_header(&l->text, d),
                "a table has at least two points");
    return false;
  }
  for (long i = 0; i < l->text.rows; i++) {
    if (i == 0 ? t[i] >= 0 : t[i] > t[i - 1]) continue;
    diag_report(d, DIAG_OUT_OF_BOUNDS, text_table_cell(&l->text, i, l->column[TIME], d),
                i == 0 ? "times must not be negative"
                       : "each time must be later than the one before");
    return false;
  }
  return true;
}

static bool take_columns(arena *a, load_file *l, const char *unit_text, double full,
                         time_function *f, diagnostics *d) {
  const size_t bytes = (size_t)l->text.rows * sizeof(double);
  double *read[PAIR] = {text_table_values(&l->text, l->column[TIME], "s", false, d), NULL};
  bool good = read[TIME] && times_ascend(l, read[TIME], d);
  if (good) read[VALUE] = text_table_values(&l->text, l->column[VALUE], unit_text, false, d);
  for (long i = 0; read[VALUE] && good && i < l->text.rows; i++) {
    read[VALUE][i] *= full;
    if (!isfinite(read[VALUE][i]))
      good = report_large(text_table_cell(&l->text, i, l->column[VALUE], d), d);
  }
  good = good && read[VALUE];
  if (good)
    set_table(a, memcpy(arena_alloc(a, bytes), read[TIME], bytes),
              memcpy(arena_alloc(a, bytes), read[VALUE], bytes), (int)l->text.rows, f);
  free(read[TIME]);
  free(read[VALUE]);
  return good;
}

/* With the full value in the deck the column holds factors; without it the load itself. */
static bool read_file(arena *a, const namelist_group *g, const deck_load_kind *kind, double full,
                      time_function *f, diagnostics *d) {
  load_file l;
  const namelist_key *given = namelist_find(g, kind->key);
  const bool good = open_file(&l, g, "file", d) && unit_suits(&l, given, kind, d) &&
                    take_columns(a, &l, given ? "1" : kind->unit, full, f, d);
  text_table_free(&l.text);
  return good;
}

/* --- formulas --------------------------------------------------------------------------------- */

static const formula *read_formula_of(arena *a, const namelist_group *g, const deck_load_kind *kind,
                                      const char *unit_text, diagnostics *d) {
  const namelist_key *key = namelist_find(g, "formula");
  if (!deck_values_counted(key, 1, d)) return NULL;
  return deck_formula_read(a, &key->values[0], "formula", kind->knows, unit_text, d);
}

/* As the table of a file: with the full value in the deck a factor, without it the load itself. */
static bool read_formula(arena *a, const namelist_group *g, const deck_load_kind *kind,
                         time_function *f, diagnostics *d) {
  const namelist_key *full = namelist_find(g, kind->key);
  f->formula = read_formula_of(a, g, kind, full || !kind->unit ? "1" : kind->unit, d);
  if (f->formula) return true;
  const diagnostic *last = &d->items[d->count - 1];
  if (full && last->code == DIAG_UNITS && !last->hint)
    diag_hint(d, "it is a factor on `%s`; leave that out where the formula is the load itself",
              full->name);
  return false;
}

/* "`total`, `moment` or `per_length`"; with their units "`total` (N) or `moment` (N*m)". */
static const char *names_of(arena *a, const deck_load_kind *kinds, int count, bool units) {
  const char *text = "";
  for (int k = 0; k < count; k++) {
    const char *join = k == 0 ? "" : k < count - 1 ? ", " : " or ";
    text = arena_printf(a, "%s%s`%s`", text, join, kinds[k].key);
    if (units) text = arena_printf(a, "%s (%s)", text, kinds[k].unit);
  }
  return text;
}

/* The one whose unit the formula has. */
static int kind_by_formula(arena *a, const namelist_group *g, const deck_load_kind *kinds,
                           int count, diagnostics *d) {
  const formula *f = read_formula_of(a, g, &kinds[0], NULL, d);
  char words[128];
  if (!f) return -1;
  for (int k = 0; k < count; k++)
    if (formula_is_zero(f) || dim_equal(formula_dimension(f), dimension_of(kinds[k].unit)))
      return k;
  dim_describe(formula_dimension(f), words, sizeof words);
  diag_report(d, DIAG_UNITS, namelist_find(g, "formula")->value_where,
              "without %s in the deck the formula is the load itself, but this is %s",
              names_of(a, kinds, count, false), words);
  diag_hint(d, "its unit is that of %s", names_of(a, kinds, count, true));
  return -1;
}

/* --- loads ------------------------------------------------------------------------------------ */

/* The one whose unit the file's column has. */
static int kind_by_unit(arena *a, const namelist_group *g, const deck_load_kind *kinds, int count,
                        diagnostics *d) {
  load_file l;
  unit given, of_kind;
  int found = -1;
  const char *bad;
  size_t bad_length;
  bool good = open_file(&l, g, "file", d) && text_table_unit(&l.text, l.column[VALUE], &given, d) &&
              unit_suits(&l, NULL, &kinds[0], d);
  for (int k = 0; good && k < count && found < 0; k++)
    if (unit_parse(kinds[k].unit, strlen(kinds[k].unit), &of_kind, &bad, &bad_length) &&
        dim_equal(given.dim, of_kind.dim))
      found = k;
  if (good && found < 0)
    diag_report(d, DIAG_UNITS, text_table_title(&l.text, l.column[VALUE], d),
                "the unit of `%s` is that of %s", name_of(&l, VALUE),
                names_of(a, kinds, count, true));
  text_table_free(&l.text);
  return found;
}

static int report_none(arena *a, const namelist_group *g, const deck_load_kind *kinds, int count,
                       diagnostics *d) {
  diag_report(d, DIAG_MISSING_KEY, g->where, "`&%s` needs %s", g->name,
              names_of(a, kinds, count, false));
  diag_hint(d,
            "or a `file` with times and values in two columns, with their units, or a `formula`");
  return -1;
}

int deck_load_kind_of(arena *a, const namelist_group *g, const deck_load_kind *kinds, int count,
                      diagnostics *d) {
  int found = -1;
  for (int k = 0; k < count; k++) {
    const namelist_key *key = namelist_find(g, kinds[k].key);
    if (key && found >= 0) {
      diag_report(d, DIAG_CONFLICT, key->name_where, "`%s` and `%s` exclude each other",
                  kinds[found].key, kinds[k].key);
      diag_note(d, namelist_find(g, kinds[found].key)->name_where, "`%s` is given here",
                kinds[found].key);
      return -1;
    }
    if (key) found = k;
  }
  if (found >= 0) return found;
  if (namelist_find(g, "formula")) return kind_by_formula(a, g, kinds, count, d);
  return namelist_find(g, "file") ? kind_by_unit(a, g, kinds, count, d)
                                  : report_none(a, g, kinds, count, d);
}

static bool read_times(arena *a, const namelist_group *g, const deck_load_kind *kind, double full,
                       time_function *f, diagnostics *d) {
  bool good = read_time(g, "start", BOUND_NOT_NEGATIVE, &f->start, d);
  good &= read_time(g, "end", BOUND_POSITIVE, &f->end, d) && ends_later(g, f, d);
  good &= read_time(g, "rise", BOUND_POSITIVE, &f->rise, d);
  const int way = way_of(a, g, kind, d);
  if (way < 0 || !good) return false;
  f->shape = way == FROM_FILE ? TIME_TABLE : (time_shape)way;
  if (way == FROM_FILE) return read_file(a, g, kind, full, f, d);
  if (way == TIME_FORMULA) return read_formula(a, g, kind, f, d);
  return f->shape != TIME_TABLE || read_table(a, g, full, f, d);
}

bool deck_factor_read(arena *a, const namelist_group *g, const char *key, time_function *f,
                      diagnostics *d) {
  *f = (time_function){.value = 1};
  const deck_load_kind kind = {.key = key, .knows = &deck_formula_of_time};
  return read_times(a, g, &kind, 1, f, d);
}

bool deck_load_read(arena *a, const namelist_group *g, const deck_load_kind *kind, time_function *f,
                    diagnostics *d) {
  const namelist_key *key = namelist_find(g, kind->key);
  *f = (time_function){.value = 1};
  const bool good =
      !key || (deck_values_counted(key, 1, d) &&
               deck_real_read(&key->values[0], key->name, kind->unit, BOUND_NONE, &f->value, d));
  return read_times(a, g, kind, f->value, f, d) && good;
}

/* --- quantities in time ----------------------------------------------------------------------- */

/* All of one unit; plain numbers fit any. */
static double *read_quantities(arena *a, const namelist_key *key, deck_quantity *unit_of,
                               diagnostics *d) {
  double *list = arena_alloc(a, (size_t)key->value_count * sizeof(double));
  for (int i = 0; i < key->value_count; i++) {
    deck_quantity q;
    if (!deck_quantity_read(&key->values[i], key->name, &q, d)) return NULL;
    list[i] = q.value;
    if (q.has_unit && unit_of->has_unit && !dim_equal(q.dim, unit_of->dim)) {
      diag_report(d, DIAG_UNITS, key->values[i].where, "the `%s` of a table have one unit",
                  key->name);
      return NULL;
    }
    if (q.has_unit) *unit_of = q;
  }
  return list;
}

static bool read_table_of_quantity(arena *a, const namelist_group *g, time_function *f,
                                   deck_quantity *unit_of, diagnostics *d) {
  const namelist_key *times = namelist_find(g, "times"), *values = namelist_find(g, "values");
  if (!times || !values) {
    diag_report(d, DIAG_MISSING_KEY, g->where, "`times` and `values` belong together");
    return false;
  }
  double *t = read_list(a, times, "times", "s", d);
  double *v = t ? read_quantities(a, values, unit_of, d) : NULL;
  if (!v || !check_times(times, t, d) || !as_many(times, values, d)) return false;
  set_table(a, t, v, times->value_count, f);
  return true;
}

static bool read_file_of_quantity(arena *a, const namelist_group *g, time_function *f,
                                  deck_quantity *unit_of, diagnostics *d) {
  load_file l;
  unit u = {DIMENSIONLESS, 1};
  char si[64];
  bool good = open_file(&l, g, "table", d) && text_table_unit(&l.text, l.column[VALUE], &u, d);
  if (good) {
    unit_of->has_unit = text_table_has_unit(&l.text, l.column[VALUE]);
    unit_of->dim = u.dim;
    dim_unit(u.dim, si, sizeof si);
    good = take_columns(a, &l, si, 1, f, d);
  }
  text_table_free(&l.text);
  return good;
}

bool deck_quantity_in_time_read(arena *a, const namelist_group *g, time_function *f,
                                deck_quantity *unit_of, diagnostics *d) {
  *f = (time_function){.shape = TIME_TABLE, .value = 1};
  *unit_of = (deck_quantity){.dim = DIMENSIONLESS};
  return (namelist_find(g, "table") ? read_file_of_quantity : read_table_of_quantity)(a, g, f,
                                                                                      unit_of, d);
}
