/* Loads whose history stands in a file: the same bits as in the deck, units, what a checkpoint, a
   result and a solver keep of it, and messages that show its lines. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>

#include "runtime/result/result_file.h"
#include "runtime/result/result_read.h"
#include "tests/generator/command_tools.h"

#define PULSE "# a pulse\ntime, w\n0, 0.25\n2e-4, 1\n5e-4, -0.5\n"

/* A small beam with `load` in the middle and result.h5 as its result. */
static void write_deck(const workplace *w, const char *name, const char *load) {
  char text[4000];
  snprintf(text, sizeof text,
           "&simulation  title = 'small beam'  end_time = '1 ms'  /\n" SMALL_BEAM "%s\n"
           "&monitor  name = 'load'  kind = 'reaction'  region = 'right'  component = 'y'  /\n"
           "&monitor  name = 'u'  kind = 'displacement'  region = 'loader'  component = 'y'  /\n"
           "&output   result = '%.*s.h5'  frames = 4  /\n",
           load, (int)strlen(name) - 4, name);
  write_text(w, name, text);
}

static void run_deck_of(workplace *w, const char *name, const char *load) {
  char line[200];
  write_deck(w, name, load);
  snprintf(line, sizeof line, "run %s", name);
  expect(w, line, 0, "written");
}

static double last_of(const workplace *w, const char *name, const char *series) {
  result_file *f = open_result_of(w, name);
  long count;
  char unit_text[64], error[1000];
  double *v =
      result_read_series(f, series, &count, unit_text, sizeof unit_text, error, sizeof error);
  assert_non_null(v);
  const double last = v[count - 1];
  free(v);
  result_read_close(f);
  return last;
}

/* --- values ----------------------------------------------------------------------------------- */

#define FORCE "&force region = 'loader' component = 'y' "

static void factors_are_those_of_the_deck(void **state) {
  workplace *w = *state;
  write_text(w, "pulse.csv", PULSE);
  run_deck_of(w, "deck.nml",
              FORCE "force = '-1 kN' times = 0, 2e-4, 5e-4 values = 0.25, 1, -0.5 /");
  run_deck_of(w, "file.nml", FORCE "force = '-1 kN' file = 'pulse.csv' /");
  expect_same_results(w, "deck.h5", "file.h5");
  run_deck_of(w, "deck.nml",
              "&gravity acceleration = 0, -9e3 start = 1e-4 times = 0, 2e-4, 5e-4 values = 0.25, "
              "1, -0.5 /");
  run_deck_of(w, "file.nml", "&gravity acceleration = 0, -9e3 start = 1e-4 file = 'pulse.csv' /");
  expect_same_results(w, "deck.h5", "file.h5");
}

/* A column with a unit is the load itself, in another order and among others. */
static void a_unit_makes_it_the_load(void **state) {
  workplace *w = *state;
  write_text(w, "log.txt", "n; F [kN]; note; t [s]\n1; -0.25; ;0\n2;-1; peak;2e-4\n3;0.5;;5e-4\n");
  run_deck_of(w, "deck.nml",
              FORCE "force = '-1 kN' times = 0, 2e-4, 5e-4 values = 0.25, 1, -0.5 /");
  run_deck_of(w, "file.nml", FORCE "file = 'log.txt:t,F' /");
  expect_same_results(w, "deck.h5", "file.h5");
  run_deck_of(w, "file.nml", FORCE "file = 'log.txt:4,2' history = 'table' /");
  expect_same_results(w, "deck.h5", "file.h5");
}

/* Half a millimetre: as places, and as a triangle of velocities. */
static void units_tell_velocity_from_displacement(void **state) {
  workplace *w = *state;
  write_text(w, "place.csv", "t [ms], u [mm]\n0, 0\n0.4, -0.3\n0.8, -0.5\n");
  write_text(w, "speed.csv", "t [ms], v [m/s]\n0, 0\n0.4, -1.25\n0.8, 0\n");
  run_deck_of(w, "a.nml", "&drive region = 'loader' component = 'y' file = 'place.csv' /");
  run_deck_of(w, "b.nml", "&drive region = 'loader' component = 'y' file = 'speed.csv' /");
  assert_true(fabs(last_of(w, "a.h5", "u") + 5e-4) < 1e-15);
  assert_true(fabs(last_of(w, "b.h5", "u") + 5e-4) < 1e-15);
  expect(w, "run a.nml --set drive.velocity=1", 1,
         "with `velocity` in the deck `u` holds factors on it, which have no unit");
}

/* The report says what a load per length amounts to; the unit of the load alone says that it is
   one. */
static void lengths_and_totals_are_told(void **state) {
  workplace *w = *state;
  static const char row[] =
      "&region name = 'row' shape = 'rectangle' corner = -1, -0.001 size = 2, 0.002 /\n"
      "&force region = 'row' component = 'y' ";
  char load[1000];
  snprintf(load, sizeof load, "%sper_length = '-2 kN/m' rise = 1e-4 /", row);
  write_deck(w, "a.nml", load);
  expect(w, "check a.nml", 0,
         "load       -2 kN/m on 0.0381 m of `row`, 7 particles: -76.2 N along y\n");
  snprintf(load, sizeof load, "%sfile = 'pulse.csv' /", row);
  write_text(w, "pulse.csv", "t [ms], q [kN/m]\n0, 0\n1, 3\n");
  write_deck(w, "a.nml", load);
  expect(w, "check a.nml", 0, "load       by length on 0.0381 m of `row`, 7 particles along y\n");
}

static void moments_come_from_files_too(void **state) {
  workplace *w = *state;
  write_text(w, "m.csv", "t [ms], M [N*m]\n0, 0\n0.2, 3\n");
  run_deck_of(w, "a.nml",
              "&end_moment region = 'end' file = 'm.csv' /\n&region name = 'end' shape "
              "= 'rectangle' corner = -1e-3, -1e-3 size = 2e-3, 12e-3 /");
  run_deck_of(w, "b.nml",
              "&end_moment region = 'end' moment = 3 rise = 2e-4 /\n&region name = "
              "'end' shape = 'rectangle' corner = -1e-3, -1e-3 size = 2e-3, 12e-3 /");
  expect(w, "compare a.h5 b.h5 --tolerance 1e-12", 0, "same");
  run_deck_of(w, "a.nml", "&force region = 'loader' file = 'm.csv' /");
  run_deck_of(w, "b.nml", "&force region = 'loader' moment = 3 rise = 2e-4 /");
  expect(w, "compare a.h5 b.h5 --tolerance 1e-12", 0, "same");
}

/* --- what is kept ----------------------------------------------------------------------------- */

static void the_result_holds_the_table(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "mkdir data"), 0);
  write_text(w, "data/pulse.csv", PULSE);
  run_deck_of(w, "a.nml",
              FORCE "force = '-1 kN' file = 'data/pulse.csv' /\n" FORCE
                    "force = 1 file = 'data/pulse.csv:1,2' /");
  result_file *f = open_result_of(w, "a.h5");
  char *text = result_read_text(f, "/input/files/data:pulse.csv");
  assert_string_equal(text, PULSE);
  free(text);
  result_read_close(f);
  expect(w, "info a.h5", 0, "Loads from files: data:pulse.csv\n");
  expect(w, "run a.nml --set output.result=data/pulse.csv", 1, "would overwrite `data/pulse.csv`");
  expect(w, "build a.nml -o data/pulse.csv", 1, "would overwrite `data/pulse.csv`");
}

static void a_changed_table_is_another_run(void **state) {
  workplace *w = *state;
  size_t size;
  write_text(w, "pulse.csv", PULSE);
  run_deck_of(w, "a.nml", FORCE "force = '-1 kN' file = 'pulse.csv' /");
  expect(w, "run a.nml --set output.frames=30 --set output.result=whole.h5", 0, "written");
  free(read_bytes(w, "whole.h5", &size));
  unlink(in_workplace(w, "a.h5"));
  assert_int_equal(
      shell(w, "ulimit -f %zu; exec $P run a.nml --set output.frames=30", (size - 1024) / 512), 2);
  write_text(w, "pulse.csv", "time, w\n0, 0.25\n2e-4, 1\n5e-4, -0.4\n");
  expect(w, "run a.nml --set output.frames=30 --resume", 1, "belongs to another deck");
  assert_non_null(strstr(w->said, "file pulse.csv, contents"));
  write_text(w, "pulse.csv", PULSE);
  expect(w, "run a.nml --set output.frames=30 --resume", 0, "written");
  expect_same_results(w, "whole.h5", "a.h5");
}

static void a_solver_takes_the_table_along(void **state) {
#if defined(__SANITIZE_ADDRESS__)
  (void)state;
  skip(); /* the solver's compiler does not know the sanitizers that the libraries were made with */
#else
  workplace *w = *state;
  write_text(w, "pulse.csv", PULSE);
  run_deck_of(w, "a.nml", FORCE "force = '-1 kN' file = 'pulse.csv' /");
  expect(w, "build a.nml -o solver", 0, "written solver");
  assert_int_equal(shell(w, "rm pulse.csv && mv a.h5 run.h5 && ./solver"), 0);
  expect_same_results(w, "run.h5", "a.h5");
#endif
}

/* --- messages --------------------------------------------------------------------------------- */

typedef struct mistake {
  const char *table, *load, *wanted;
} mistake;

static void messages_show_the_line(void **state) {
  workplace *w = *state;
  static const mistake list[] = {
      {PULSE, FORCE "file = 'pulse.csv' /",
       "pulse.csv:2:7: error: `w` has no unit: it is a load with one, or a factor on `total`"},
      {PULSE, FORCE "file = 'pulse.csv' /", "hint: write `w [N]`, or give `total`"},
      {"t, F [m]\n0, 1\n1, 2\n", FORCE "file = 'pulse.csv' /",
       "pulse.csv:1:4: error: the unit of `F` is that of `total` (N), `moment` (N*m) or "
       "`per_length` (N/m) [units]\n  1 | t, F [m]"},
      {"t, F [kN]\n0, 1\n1, 2\n", FORCE "force = 1 file = 'pulse.csv' /",
       "leave `total` out where the column is the load itself"},
      {"t [mm], w\n0, 1\n1, 2\n", FORCE "force = 1 file = 'pulse.csv' /",
       "the unit of `t` is one of `s`"},
      {"t, w\n0, 1\n0, 2\n", FORCE "force = 1 file = 'pulse.csv' /",
       "pulse.csv:3:1: error: each time must be later"},
      {"t, w\n-1, 1\n0, 2\n", FORCE "force = 1 file = 'pulse.csv' /", "must not be negative"},
      {"t, w\n0, 1\n", FORCE "force = 1 file = 'pulse.csv' /", "at least two points"},
      {"t, w\n", FORCE "force = 1 file = 'pulse.csv' /", "at least two points"},
      {"", FORCE "force = 1 file = 'pulse.csv' /", "has 0 columns; a load has two"},
      {"t, w\n0, 1\n1, \n", FORCE "force = 1 file = 'pulse.csv' /", "here is no value of `w`"},
      {"t, w\n0, 1\n1, 1e200\n", FORCE "force = 1e200 file = 'pulse.csv' /", "is too large"},
      {"t, v, w\n0, 1, 2\n1, 2, 3\n", FORCE "force = 1 file = 'pulse.csv' /",
       "has 3 columns; a load has two, time and value"},
      {"t, v, w\n0, 1, 2\n1, 2, 3\n", FORCE "force = 1 file = 'pulse.csv' /",
       "by names or numbers: file = 'FILE:t,v'"},
      {"t, v, w\n0, 1, 2\n1, 2, 3\n", FORCE "force = 1 file = 'pulse.csv:t,u' /",
       "`pulse.csv` has no column `u`"},
      {PULSE, FORCE "force = 1 file = 'pulse.csv:w' /", "FILE:TIME,VALUE"},
      {PULSE, FORCE "force = 1 file = 'pulse.csv' values = 0, 1 /",
       "`values` does not go with a table from a file"},
      {PULSE, FORCE "force = 1 file = 'pulse.csv' rise = 1 history = 'ramp' /",
       "`file` does not go with a ramp"},
      {PULSE, FORCE "force = 1 file = 'puls.csv' /", "cannot read `puls.csv`: No such file"},
      {PULSE, FORCE "force = 1 file = '.' /", "it is a folder"},
      {PULSE, FORCE "force = 1 file = 7 /", "`file` is the name of a table in quotes"},
      {PULSE, "&end_moment region = 'loader' /", "`&end_moment` needs `moment`"},
      {"t, M [N*m]\n0, 1\n1, 2\n", FORCE "file = 'pulse.csv' /",
       "a force along y is in N or N/m, this is in N*m"},
      {"t, u [mm]\n0, 1\n1, 2\n", "&drive region = 'loader' component = 'y' file = 'pulse.csv' /",
       "warning: this displacement begins with a jump"},
      {"t, a [m/s^2]\n0, 1\n1, 2\n", "&gravity acceleration = 0, 1 file = 'pulse.csv' /",
       "with `acceleration` in the deck `a` holds factors"},
  };
  for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
    write_text(w, "pulse.csv", list[k].table);
    write_deck(w, "a.nml", list[k].load);
    const bool warning = strstr(list[k].wanted, "warning:") != NULL;
    expect(w, "check a.nml", warning ? 0 : 1, list[k].wanted);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
#define IN_WORKPLACE(test)                                                                         \
  cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
      IN_WORKPLACE(factors_are_those_of_the_deck),
      IN_WORKPLACE(a_unit_makes_it_the_load),
      IN_WORKPLACE(units_tell_velocity_from_displacement),
      IN_WORKPLACE(lengths_and_totals_are_told),
      IN_WORKPLACE(moments_come_from_files_too),
      IN_WORKPLACE(the_result_holds_the_table),
      IN_WORKPLACE(a_changed_table_is_another_run),
      IN_WORKPLACE(a_solver_takes_the_table_along),
      IN_WORKPLACE(messages_show_the_line)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
