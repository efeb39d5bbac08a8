/* Tables of numbers in texts: what stands between columns, names, units, gaps, and where messages
   point. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/base/text_table.h"

typedef struct bench {
  source_set sources;
  diagnostics d;
  text_table t;
  bool read;
} bench;

static void begin(bench *b, const char *text) {
  *b = (bench){.sources = {NULL, 0}};
  diag_begin(&b->d, &b->sources);
  source_add(&b->sources, "t.csv", text, strlen(text));
  b->read = text_table_read(&b->t, strdup("t.csv"), (span){0, 0, 0}, &b->d);
}

static void end(bench *b) {
  text_table_free(&b->t);
  diag_clear(&b->d);
  source_clear(&b->sources);
}

static void column_is(bench *b, const char *name, const char *si_unit, const double *wanted) {
  const int column = text_table_column(&b->t, name, (span){0, 0, 0}, &b->d);
  assert_true(column >= 0);
  double *values = text_table_values(&b->t, column, si_unit, true, &b->d);
  assert_non_null(values);
  for (long k = 0; k < b->t.rows; k++)
    if (isnan(wanted[k]) ? !isnan(values[k])
                         : !(fabs(values[k] - wanted[k]) <= 1e-15 * fabs(wanted[k])))
      fail_msg("%s, row %ld: %.17g instead of %.17g", name, k, values[k], wanted[k]);
  free(values);
}

/* One table in every notation. */
static void separators(void **state) {
  (void)state;
  static const char *const texts[] = {
      "time [ms], F_2 [kN], w\n0, 1, 0.5\n2,-3e1,.25\n",
      "# a comment\n\n time [ms] ; F_2 [kN] ; w, the factor \r\n0;1;0.5\r\n2; -30 ;0.25\r\n",
      "\xef\xbb\xbf"
      "time [ms]\tF_2 [kN]\tw\n0\t1\t0.5\n# between\n2\t-30\t0.25",
      "  time  [ms]   F_2 [kN] w  \n 0 1 0.5\n2   -30\t0.25  \n",
      "\"time [ms]\",\"F_2 [kN]\",\"w, the factor\"\n0,\"1\",0.5\n2,-30,0.25\n",
      "time (ms), F_2 (kN), w\n0, 1, 0.5\n2, -30, 0.25\n"};
  for (size_t n = 0; n < sizeof texts / sizeof *texts; n++) {
    bench b;
    begin(&b, texts[n]);
    assert_true(b.read && b.t.rows == 2 && b.t.column_count == 3);
    column_is(&b, "time", "s", (const double[]){0, 2e-3});
    column_is(&b, "f_2", "N", (const double[]){1e3, -3e4});
    column_is(&b, "3", "1", (const double[]){0.5, 0.25});
    assert_true(text_table_has_unit(&b.t, 1) && !text_table_has_unit(&b.t, 2));
    end(&b);
  }
}

/* Numbers alone: columns by their number, in SI. */
static void tables_without_names(void **state) {
  (void)state;
  bench b;
  begin(&b, "# F over t\n0 1\n1e-3 2\n");
  assert_true(b.read && b.t.rows == 2);
  column_is(&b, "1", "s", (const double[]){0, 1e-3});
  column_is(&b, "2", "N", (const double[]){1, 2});
  assert_true(text_table_column(&b.t, "3", (span){0, 0, 0}, &b.d) == TEXT_TABLE_NONE);
  assert_string_equal(b.d.items[0].hint, "its columns are 1 to 2");
  end(&b);
}

static void gaps_and_words_in_other_columns(void **state) {
  (void)state;
  bench b;
  begin(&b, "x [%], note, y (mean), z [-]\n1, start, , 1\n2, , 4, 2\n");
  assert_true(b.read);
  column_is(&b, "x", "1", (const double[]){0.01, 0.02});
  column_is(&b, "y (mean)", "m", (const double[]){NAN, 4});
  column_is(&b, "z", "1", (const double[]){1, 2});
  end(&b);
}

typedef struct bad_table {
  const char *text, *column, *unit, *code, *message, *hint;
  int line, place;
} bad_table;

static void messages_point_into_the_table(void **state) {
  (void)state;
  static const bad_table bad[] = {
      {"t [ms], F [kN]\n0, 1\n", "F", "m", "units", "the unit of `F` is one of `m`", NULL, 1, 12},
      {"t, F [kn]\n0, 1\n", "F", "N", "unknown-unit", "no unit `kn`", "`kN`", 1, 7},
      {"t, F [kN\n0, 1\n", "", "", "syntax", "no closing `]`", NULL, 1, 6},
      {"t, F\n0, 1\n\n0, 1, 2\n", "", "", "bad-value", "more values than the 2", NULL, 4, 1},
      {"t, F\n0, 1\n0\n", "", "", "bad-value", "fewer values than the 2", NULL, 3, 1},
      {"t; F\n0,1; 1\n", "t", "s", "bad-number", "`t` is not a number", "a point", 2, 1},
      {"1 2\n3 x\n", "2", "s", "bad-number", "column 2 is not a number", NULL, 2, 3},
      {"t, F [kN]\n0, 1e306\n", "F", "N", "bad-number", "`F` is not finite", NULL, 2, 4},
      {"t, F\n0, 1\n", "G", "N", "unknown-name", "has no column `G`", "`t`, `F`", 1, 1},
      {"t, F, f\n0, 1, 2\n", "F", "N", "duplicate-name", "second column `F`", NULL, 1, 7},
  };
  for (size_t n = 0; n < sizeof bad / sizeof *bad; n++) {
    const bad_table *is = &bad[n];
    bench b;
    begin(&b, is->text);
    const int column =
        b.read ? text_table_column(&b.t, is->column, (span){0, 0, 0}, &b.d) : TEXT_TABLE_NONE;
    if (column >= 0) assert_null(text_table_values(&b.t, column, is->unit, true, &b.d));
    assert_int_equal(b.d.count, 1);
    const diagnostic *d = &b.d.items[0];
    const place at = source_place(&b.sources, d->where.file, d->where.begin);
    if (strcmp(diag_name(d->code), is->code) != 0 || !strstr(d->message, is->message) ||
        at.line != is->line || at.column != is->place ||
        (is->hint && !(d->hint && strstr(d->hint, is->hint))))
      fail_msg("table %zu: %d:%d: %s [%s] %s", n, at.line, at.column, d->message,
               diag_name(d->code), d->hint ? d->hint : "");
    end(&b);
  }
  bench b;
  begin(&b, "t, F\n0,\n");
  assert_null(text_table_values(&b.t, 1, "N", false, &b.d));
  assert_string_equal(b.d.items[0].message, "here is no value of `F`");
  end(&b);
}

static void split_is(const char *given, const char *path, const char *columns) {
  const char *found;
  char *split = text_table_split(given, &found);
  assert_string_equal(split, path);
  if (columns)
    assert_string_equal(found, columns);
  else
    assert_null(found);
  free(split);
}

static void columns_behind_a_colon(void **state) {
  (void)state;
  char *names[2];
  split_is("lab.csv", "lab.csv", NULL);
  split_is("../a.b/lab.csv:cmod,load", "../a.b/lab.csv", "cmod,load");
  split_is("at 12:30/lab.txt:1,2", "at 12:30/lab.txt", "1,2");
  split_is("2024-05-01T12:30.csv", "2024-05-01T12:30.csv", NULL);
  assert_int_equal(text_table_names(" cmod , load_low,c", names, 2), 3);
  assert_string_equal(names[0], "cmod");
  assert_string_equal(names[1], "load_low");
  free(names[0]);
  free(names[1]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(separators), cmocka_unit_test(tables_without_names),
      cmocka_unit_test(gaps_and_words_in_other_columns),
      cmocka_unit_test(messages_point_into_the_table), cmocka_unit_test(columns_behind_a_colon)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
