/* A picture of a study's table has at most 64 curves; how many more there are is said. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "generator/study/study_plot.h"
#include "generator/study/study_table.h"

enum { MOST_CASES = 80 };

/* A case for each value of beta, at one speed. */
static void write_table(arena *a, const char *path, int cases) {
  static study_row rows[MOST_CASES];
  const char **names = arena_alloc(a, MOST_CASES * sizeof *names);
  double speed[MOST_CASES], peak[MOST_CASES];
  study_table t = {.rows = cases};
  for (int k = 0; k < cases; k++) {
    names[k] = arena_printf(a, "speed=20,beta=%d", k);
    speed[k] = 20;
    peak[k] = k;
  }
  study_table_add(a, &t, &(study_column){.name = "case", .texts = names});
  study_table_add(a, &t, &(study_column){.name = "speed", .unit = "mm/s", .values = speed});
  study_table_add(a, &t, &(study_column){.name = "load peak", .unit = "N", .values = peak});
  assert_true(study_table_hdf5(&t, rows, path));
}

/* What is said of a picture of so many curves; "" where nothing is. */
static const char *said_of(int curves) {
  static char said[512];
  char table[] = "/tmp/perilat-table-XXXXXX.h5", picture[] = "/tmp/perilat-table-XXXXXX.png";
  const plot_curve_options o = {.output = picture, .x = "speed", .y = "load peak"};
  arena *a = arena_new();
  FILE *heard = tmpfile();
  const int errors = dup(STDERR_FILENO);
  close(mkstemps(table, 3));
  close(mkstemps(picture, 4));
  write_table(a, table, curves);
  fflush(stderr);
  dup2(fileno(heard), STDERR_FILENO);
  const bool good = study_plot(table, &o, 0);
  fflush(stderr);
  dup2(errors, STDERR_FILENO);
  close(errors);
  rewind(heard);
  said[fread(said, 1, sizeof said - 1, heard)] = 0;
  fclose(heard);
  unlink(table);
  unlink(picture);
  arena_free(a);
  assert_true(good);
  return said;
}

static void curves_left_out_are_told(void **state) {
  (void)state;
  assert_string_equal(said_of(64), "");
  assert_string_equal(said_of(67), "perilat: warning: of 67 curves the first 64 are drawn\n");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(curves_left_out_are_told)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
