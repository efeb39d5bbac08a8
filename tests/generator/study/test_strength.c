/* A hold is lengthened while the body still comes to rest. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/command_tools.h"

/* Field number `column` (from 1) of the table's line `line`, names in quotes without commas. */
static void expect_cell(workplace *w, const char *table, int line, const char *title,
                        const char *value) {
  assert_int_equal(shell(w,
                         "python3 -c \"import csv; r = list(csv.reader(open('%s'))); "
                         "print(r[%d][r[0].index('%s')])\"",
                         table, line, title),
                   0);
  w->said[strcspn(w->said, "\n")] = 0;
  assert_string_equal(w->said, value);
}

/* A beam whose concrete stays whole, damped, loaded within a fifth of its period of 0.094 ms and
   held for 0.48 ms. */
static const char held_deck[] =
    "&simulation  title = 'held beam'  end_time = '0.5 ms'  /\n" SMALL_BEAM
    "&force       region = 'loader'  component = 'y'  total = '-100 N'  rise = '0.02 ms'  /\n"
    "&damping     ratio = 0.1  /\n"
    "&monitor     name = 'deflection'  kind = 'displacement'  region = 'loader'  component = 'y'  "
    "scale = -1  /\n"
    "&output      result = 'held.h5'  frames = 0  /\n";

/* The swing dies out: the hold is doubled as often as is allowed, then the load is borne. */
static void holds_are_lengthened(void **state) {
  workplace *w = *state;
  static const char loads[] = "strength = 'force.total = -100 N'";
  write_text(w, "held.nml", held_deck);
  expect(w, "study held.nml --strength 'force.total=-100 N' -o four", 2,
         "no load made it collapse");
  expect_cell(w, "four.csv", 1, "end_time [ms]", "1.94");
  expect_cell(w, "four.csv", 1, "verdict", "borne");
  assert_int_equal(shell(w,
                         "for n in 0 2 3; do echo \"&study deck='held.nml' %s longest=$n/\" > "
                         "$n.nml; $P study $n.nml; [ $? = 2 ] || exit 9; done",
                         loads),
                   0);
  expect_cell(w, "0_study.csv", 1, "end_time [ms]", "0.5");
  expect_cell(w, "2_study.csv", 1, "end_time [ms]", "0.98");
  expect_cell(w, "3_study.csv", 1, "end_time [ms]", "0.98");
  /* loaded over four periods it hardly swings */
  expect(w,
         "study held.nml --strength 'force.total=-100 N' --set 'force.rise=0.4 ms' --set "
         "'simulation.end_time=0.88 ms' -o calm",
         2, "bears 100 N");
  expect_cell(w, "calm.csv", 1, "end_time [ms]", "0.88");
}

/* The table has what the verdicts rest on, and the rule stands below. */
static void the_verdict_is_explained(void **state) {
  workplace *w = *state;
  write_text(w, "held.nml", held_deck);
  write_text(w, "moved.nml", held_deck);
  expect(w,
         "study held.nml --strength 'force.total=100 N' --set 'force.rise=0.4 ms' --set "
         "'simulation.end_time=0.88 ms' --twin moved.nml -o told",
         2, "first half [m]  second half [m]  verdict");
  assert_non_null(
      strstr(w->said, "`deflection` is the same in both halves of the hold, within 5 %"));
  assert_non_null(strstr(w->said, "  twin: `moved.nml`, told/moved.h5\n"));
  assert_non_null(
      strstr(w->said, "--strength:1:1: warning: these loads act against the deck's own"));
}

/* What comes after the first hold is seen in the second: here another force. */
static void a_longer_hold_tells(void **state) {
  workplace *w = *state;
  write_text(w, "held.nml", held_deck);
  assert_int_equal(shell(w, "echo \"&force region='loader' component='y' total='-100 N' start='0.7 "
                            "ms' rise='0.02 ms' /\" >> held.nml"),
                   0);
  expect(w, "study held.nml --strength 'force[1].total=-100 N' -o later", 2, "does not bear 100 N");
  expect_cell(w, "later.csv", 1, "end_time [ms]", "0.98");
  expect_cell(w, "later.csv", 1, "verdict", "collapsed");
}

int main(void) {
#define WITH(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {WITH(holds_are_lengthened), WITH(a_longer_hold_tells),
                                     WITH(the_verdict_is_explained)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
