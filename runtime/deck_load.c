#include "runtime/deck_load.h"

#include <math.h>

enum { SHAPES = TIME_TABLE + 1 };

static const char *const shape_choices = "constant|ramp|ramp and hold|cosine|table";
static const char *const shape_words[SHAPES] = {"a constant load", "a ramp", "a ramp and hold",
                                                "a cosine", "a table"};

enum {
  RISING = 1 << TIME_RAMP | 1 << TIME_RAMP_HOLD | 1 << TIME_COSINE,
  TABULATED = 1 << TIME_TABLE
};
static const deck_key_use uses[] = {
    {"rise", RISING, true}, {"times", TABULATED, true}, {"values", TABULATED, true}};

static bool read_shape(arena *a, const namelist_group *g, time_function *f, diagnostics *d) {
  const namelist_key *history = namelist_find(g, "history");
  int shape = TIME_CONSTANT;
  if (history)
    shape = deck_choice_read(a, history, shape_choices, d);
  else if (namelist_find(g, "rise"))
    shape = TIME_RAMP_HOLD;
  else if (namelist_find(g, "times") || namelist_find(g, "values"))
    shape = TIME_TABLE;
  if (shape < 0) return false;
  f->shape = (time_shape)shape;
  return deck_keys_fit(g, uses, 3, shape, shape_words[shape], d);
}

static bool read_time(const namelist_group *g, const char *name, deck_bound bound, double *time,
                      diagnostics *d) {
  const namelist_key *key = namelist_find(g, name);
  if (!key) return true;
  return deck_values_counted(key, 1, d) &&
         deck_real_read(&key->values[0], name, "s", bound, time, d);
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

/* The table's factors times the full value: the function then needs no other. */
static bool read_table(arena *a, const namelist_group *g, time_function *f, diagnostics *d) {
  const namelist_key *times = namelist_find(g, "times"), *values = namelist_find(g, "values");
  double *t = read_list(a, times, "times", "s", d);
  double *v = t ? read_list(a, values, "values", "1", d) : NULL;
  if (!v) {
    if (d->items[d->count - 1].code == DIAG_UNITS && t)
      diag_hint(d, "`values` are factors on the full value");
    return false;
  }
  if (!check_times(times, t, d)) return false;
  if (times->value_count != values->value_count) {
    diag_report(d, DIAG_BAD_VALUE, values->value_where,
                "`times` and `values` must be equally many, but they are %d and %d",
                times->value_count, values->value_count);
    diag_note(d, times->value_where, "the times");
    return false;
  }
  for (int i = 0; i < values->value_count; i++) {
    v[i] *= f->value;
    if (isfinite(v[i])) continue;
    diag_report(d, DIAG_BAD_NUMBER, values->values[i].where, "the value of the load is too large");
    return false;
  }
  f->times = t;
  f->values = v;
  f->count = times->value_count;
  return true;
}

static bool read_times(arena *a, const namelist_group *g, time_function *f, diagnostics *d) {
  bool good = read_time(g, "start", BOUND_NOT_NEGATIVE, &f->start, d);
  good &= read_time(g, "rise", BOUND_POSITIVE, &f->rise, d);
  if (!read_shape(a, g, f, d) || !good) return false;
  return f->shape != TIME_TABLE || read_table(a, g, f, d);
}

bool deck_factor_read(arena *a, const namelist_group *g, time_function *f, diagnostics *d) {
  *f = (time_function){.value = 1};
  return read_times(a, g, f, d);
}

bool deck_load_read(arena *a, const namelist_group *g, const namelist_key *key,
                    const char *unit_text, time_function *f, diagnostics *d) {
  *f = (time_function){0};
  const bool good = deck_values_counted(key, 1, d) &&
                    deck_real_read(&key->values[0], key->name, unit_text, BOUND_NONE, &f->value, d);
  return read_times(a, g, f, d) && good;
}
