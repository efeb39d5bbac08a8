/* Laboratory data beside results: the distance of a computed curve from points and bands, against
   closed forms; tables, bands and lines in pictures, by the places that they get there;
   messages. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>

#include "generator/results/curve_gap.h"
#include "tests/generator/command_tools.h"
#include "tests/runtime/small_result.h"

static void near(double got, double wanted) {
  if (!(fabs(got - wanted) <= 1e-14 * fmax(1, fabs(wanted))))
    fail_msg("%.17g instead of %.17g", got, wanted);
}

/* --- distance --------------------------------------------------------------------------------- */

/* y = 2x against y = 0 and 1 at x = 0 and 1, then 1: the distance grows as x to 1, then as 1 + 2(x
   - 1). */
static void points_of_straight_lines(void **state) {
  (void)state;
  const double x[] = {0, 3}, y[] = {0, 6}, at[] = {-1, 0, 1, NAN, 2}, is[] = {9, 0, 1, 5, 1};
  const curve_points points = {at, is, is, 5};
  curve_gap g;
  assert_true(curve_gap_find(x, y, 2, &points, &g));
  near(g.from, 0);
  near(g.to, 2);
  near(g.largest, 3);
  near(g.x, 2);
  near(g.y, 4);
  near(g.low, 1);
  near(g.rms, sqrt((1.0 / 3 + 13.0 / 3) / 2)); /* integrals of x^2 and (1 + 2x)^2 from 0 to 1 */
}

/* y = x leaves the band from 0.25 to 0.75 on both sides. */
static void what_is_outside_of_a_band(void **state) {
  (void)state;
  const double x[] = {0, 1}, y[] = {0, 1}, at[] = {0, 1}, low[] = {0.25, 0.25},
               high[] = {0.75, 0.75};
  const curve_points band = {at, low, high, 2};
  curve_gap g;
  assert_true(curve_gap_find(x, y, 2, &band, &g));
  near(g.largest, 0.25);
  near(g.rms, sqrt(2 * pow(0.25, 3) / 3));
  const double inside[] = {0.5, 0.75};
  assert_true(curve_gap_find(x, inside, 2, &band, &g));
  near(g.largest, 0);
  near(g.rms, 0);
}

/* The drawing in curve_gap.h: from x = 2 on the way from (1.5, 1) to (4, 1) counts. */
static void the_first_time_counts(void **state) {
  (void)state;
  const double x[] = {0, 2, 1.5, 4}, y[] = {0, 2, 1, 1}, at[] = {0, 2, 2.5, 4}, is[] = {0, 2, 1, 1};
  const curve_points points = {at, is, is, 4};
  curve_gap g;
  assert_true(curve_gap_find(x, y, 4, &points, &g));
  near(g.largest, 1); /* just behind x = 2 */
  near(g.x, 2);
  near(g.y, 1);
  near(g.low, 2);
  near(g.rms, sqrt(0.5 / 3 / 4)); /* 1 - 2(x - 2) to x = 2.5 */
}

/* Downward in x, a table from its far end, and points that come back in x. */
static void directions(void **state) {
  (void)state;
  const double x[] = {0, -1, -2}, y[] = {0, 1, 2}, at[] = {-2, -1.5, -1.75, 0},
               is[] = {2.5, 2, 9, 0.5};
  const curve_points points = {at, is, is, 4};
  curve_gap g;
  assert_true(curve_gap_find(x, y, 3, &points, &g));
  near(g.from, 0);
  near(g.to, -2);
  near(g.largest, 9 - 1.75); /* read backwards, 9 stands before 2 */
  near(g.x, -1.75);
  const double apart[] = {5, 6};
  const curve_points elsewhere = {apart, is, is, 2};
  assert_false(curve_gap_find(x, y, 3, &elsewhere, &g));
  const double nothing[] = {NAN, NAN};
  const curve_points none = {nothing, is, is, 2};
  assert_false(curve_gap_find(x, y, 3, &none, &g));
}

/* --- a result and tables ---------------------------------------------------------------------- */

/* Load 1000 N over `end` (s), at 5 samples; cmod 2 mm. A quasi-static run keeps its steps. */
static void make_result_of(const workplace *w, double end, bool quasi_static) {
  char error[512];
  double u[2 * PARTICLES], omega[BONDS], time[SAMPLES], load[SAMPLES], cmod[SAMPLES],
      steps[SAMPLES] = {0};
  const double *values[] = {u, omega};
  const result_header h = small_header(in_workplace(w, "a.h5"));
  result *r = small_begin(&h, error, sizeof error);
  assert_non_null(r);
  small_frame(0, u, omega);
  assert_true(result_frame(r, 0, values, error, sizeof error));
  for (int k = 0; k < SAMPLES; k++) {
    time[k] = 0.25 * k * end;
    load[k] = 250 * k;
    cmod[k] = 0.5e-3 * k;
  }
  const result_series series[] = {{.name = "load", .unit = "N", .values = load},
                                  {.name = "energy/kinetic", .unit = "J", .values = load},
                                  {.name = "cmod", .unit = "m", .values = cmod},
                                  {.name = "relaxation_steps", .unit = "1", .values = steps}};
  const result_ending e = {.ended = "at the end",
                           .dt = 1e-3,
                           .steps = 42,
                           .time = time,
                           .history_count = SAMPLES,
                           .series = series,
                           .series_count = quasi_static ? 4 : 3};
  assert_true(result_finish(r, &e, error, sizeof error));
  result_discard(r);
  result_close(r);
}

static void make_result(const workplace *w) {
  make_result_of(w, 1, false);
}

#define LAB                                                                                        \
  "# a test\ncmod [mm], load [kN], low [kN], high [kN]\n0.2, 0, 0, 0.2\n2.4, 1.1, 1, 1.3\n"

typedef struct run_line {
  const char *line;
  int status;
  const char *wanted;
} run_line;

static void expect_all(workplace *w, const run_line *list, size_t count) {
  for (size_t k = 0; k < count; k++)
    expect(w, list[k].line, list[k].status, list[k].wanted);
}
#define COUNT(list) (sizeof(list) / sizeof *(list))

/* From 0.2 to 2 mm the points lie 100 N below the curve: 1/11 of 1.1 kN. The band's lower side is
   100 N below and its upper one 100 N above at 0.2 mm; at 2 mm they are 818.2 and 1100 N. */
static void a_curve_is_compared_with_a_table(void **state) {
  workplace *w = *state;
  make_result(w);
  write_text(w, "lab.csv", LAB);
  write_text(w, "log.txt", "1 0\n2 1100\n");
  write_text(w, "energy.csv", "time [s], kinetic [J]\n0, 0\n1, 1000\n");
  static const run_line list[] = {
      {"compare a.h5 lab.csv --x cmod", 2, "* load [N]                                    100"},
      {"compare a.h5 lab.csv --x cmod", 2, "      0.09091      0.09091  cmod = "},
      {"compare a.h5 lab.csv --x cmod", 2,
       "compared over cmod from 0.2 to 2 mm; the table goes from 0.2 to 2.4 mm\n"},
      {"compare a.h5 lab.csv --x cmod --tolerance 0.0909", 2, "apart from `lab` by more than"},
      {"compare a.h5 lab.csv --x cmod --tolerance 0.0910", 0, "same: apart from `lab` by no more"},
      {"compare a.h5 lab.csv:cmod,load --x cmod --y load --tolerance 0.1", 0, "same"},
      {"compare a.h5 lab.csv --x cmod --band low,high", 0,
       "out of the band                      0            0            0  cmod"},
      {"compare a.h5 lab.csv --x cmod --band high,high --tolerance 0.07", 2, "by more than 0.07"},
      {"compare a.h5 log.txt:1,2 --x cmod", 1, "no range of `cmod` in common"},
      {"compare a.h5 energy.csv --y energy/kinetic", 0, "same: apart from `energy` by no more"},
      {"compare a.h5 energy.csv --y kinetic", 0, "same: apart"},
      {"compare a.h5 lab.csv", 1, "`lab.csv` has no column `time`"},
      {"compare a.h5 lab.csv", 1, "hint: its columns are `cmod`, `load`, `low`, `high`; say which"},
      {"compare a.h5 lab.csv:cmod,lod --x cmod", 1,
       "compare:1:1: error: `lab.csv` has no column `lod`"},
      {"compare a.h5 lab.csv:cmod --x cmod", 1, "a curve has two columns: FILE:X,Y"},
      {"compare a.h5 lab.csv --x load --y cmod", 2, "* cmod [m] "},
      {"compare a.h5 lab.csv:load,load --x cmod", 1,
       "lab.csv:2:18: error: the unit of `load` is one of `m` [units]\n  2 | cmod [mm], load [kN]"},
      {"compare a.h5 lab.csv --x cmod --band high,low", 1,
       "lab.csv:3:12: error: here the lower side of the band is above"},
      {"compare a.h5 lab.csv --x cmod --band low", 1, "--band LOW,HIGH"},
      {"compare a.h5 lab.csv --x nothing", 1, "has no history `nothing`"},
      {"compare lab.csv a.h5", 1, "needs a result first, then a table"},
      {"compare a.h5 a.h5 --x cmod", 1, "--x, --y and --band are for a result and a table"},
      {"compare a.h5 lab.csv --x cmod --history load", 1,
       "--history and --field compare two results"},
      {"compare a.h5 nothing.csv", 1, "cannot read `nothing.csv`: No such file"},
      {"compare a.h5", 1, "two results, or a result and a table"},
  };
  expect_all(w, list, COUNT(list));
}

/* --- pictures --------------------------------------------------------------------------------- */

static void picture_has(workplace *w, const char *name, const char *wanted) {
  size_t size;
  char *text = read_bytes(w, name, &size);
  const bool found = strstr(text, wanted) != NULL;
  free(text);
  if (!found) fail_msg("%s: no %s", name, wanted);
}

static void same_pictures(workplace *w, const char *a, const char *b, bool same) {
  size_t sizes[2];
  char *texts[2] = {read_bytes(w, a, &sizes[0]), read_bytes(w, b, &sizes[1])};
  assert_true((sizes[0] == sizes[1] && memcmp(texts[0], texts[1], sizes[0]) == 0) == same);
  free(texts[0]);
  free(texts[1]);
}

/* The frame is 120 to 1160 and 705 up to 70; the axes go to 1 s and 1 kN. */
static void points_bands_and_lines_stand_where_they_should(void **state) {
  workplace *w = *state;
  make_result(w);
  write_text(w, "m.csv",
             "time [s], load [N], low [N], high [N]\n0.25, 500, 250, 750\n0.75, 1000, 500, 1000\n");
  expect(w, "plot a.h5 --data m.csv --label computed --label lab -o points.svg", 0, "written");
  picture_has(w, "points.svg", "M 380 387.5 L 900 70");
  expect(w, "plot a.h5 --data m.csv --band low,high -o band.svg", 0, "written");
  picture_has(w, "band.svg", "M 380 546.25 L 900 387.5 L 900 70 L 380 228.75 Z");
  write_text(w, "n.csv", "time [s], low [N], high [N]\n0.25, 250, 750\n, ,\n0.75, 500, 1000\n");
  expect(w, "plot a.h5 --data n.csv --band low,high -o alone.svg", 0, "written");
  expect(w, "plot a.h5 --data n.csv:time --band 2,3 -o named.svg", 0, "written");
  same_pictures(w, "alone.svg", "named.svg", true);
  expect(w, "plot a.h5 --line 'half = 0.5 kN' --line '1 N' -o line.svg", 0, "written");
  picture_has(w, "line.svg", "stroke-dasharray");
  picture_has(w, "line.svg", "M 120 387.5 L 1160 387.5");
  expect(w, "plot a.h5 --band '250 N, 0.75kN' -o levels.svg", 0, "written");
  picture_has(w, "levels.svg", "M 120 228.75 L 1160 228.75 L 1160 546.25 L 120 546.25 Z");
}

/* One table in other units is the same picture; another value is not. */
static void units_are_those_of_the_axes(void **state) {
  workplace *w = *state;
  make_result(w);
  write_text(w, "lab.csv", "time [s], load [N]\n0.25, 500\n0.75, 1000\n");
  expect(w, "plot a.h5 --data lab.csv -o si.svg", 0, "written");
  write_text(w, "lab.csv", "Load [kN]; n; TIME [ms]\n0.5; 1; 250\n1; 2; 750\n");
  expect(w, "plot a.h5 --data lab.csv -o other.svg", 0, "written");
  same_pictures(w, "si.svg", "other.svg", true);
  write_text(w, "lab.csv", "0.25 500\n0.75 1000\n");
  expect(w, "plot a.h5 --data lab.csv:1,2 -o other.svg", 0, "written");
  same_pictures(w, "si.svg", "other.svg", true);
  write_text(w, "lab.csv", "time, load\n0.25, 500\n0.75, 999\n");
  expect(w, "plot a.h5 --data lab.csv -o other.svg", 0, "written");
  same_pictures(w, "si.svg", "other.svg", false);
}

/* Creep in increments: its time is in s as in every result, is drawn in hours, and meets tables. */
static void quasi_static_runs_have_time(void **state) {
  workplace *w = *state;
  make_result_of(w, 36000, true);
  write_text(w, "lab.csv", "time [h], load [N]\n2.5, 250\n7.5, 760\n");
  static const run_line list[] = {
      {"plot a.h5 --x-unit h -o hours.svg", 0, "written"},
      {"plot a.h5 -o own.svg", 0, "written"},
      {"plot a.h5 --x-unit s -o seconds.svg", 0, "written"},
      {"plot a.h5 --data lab.csv -o lab.svg", 0, "written"},
      {"compare a.h5 lab.csv", 2, "time = 7.5 h: 750 and 760\n"},
      {"compare a.h5 lab.csv", 2, "compared over time from 2.5 to 7.5 h\n"},
  };
  expect_all(w, list, COUNT(list));
  same_pictures(w, "hours.svg", "own.svg", true);
  same_pictures(w, "hours.svg", "seconds.svg", false);
}

static void mistakes_of_plot(void **state) {
  workplace *w = *state;
  make_result(w);
  write_text(w, "lab.csv", LAB);
  static const run_line list[] = {
      {"plot a.h5 --x cmod --data lab.csv -o c.png", 0, "written c.png"},
      {"plot a.h5 --x cmod --y energy/kinetic --data lab.csv", 1,
       "--data:1:1: error: `lab.csv` has no column `energy/kinetic`"},
      {"plot a.h5 --x cmod --y cmod --data lab.csv:cmod,load", 1,
       "lab.csv:2:18: error: the unit of `load` is one of `m`"},
      {"plot a.h5 --x cmod --band low,high --data lab.csv", 1,
       "--band low,high follows the --data"},
      {"plot a.h5 --x cmod --data lab.csv --band low,hig", 1,
       "--band:1:1: error: `lab.csv` has no column `hig`"},
      {"plot a.h5 --line '5 mm'", 1, "--line needs a value in a unit of `N`"},
      {"plot a.h5 --line 'theory'", 1, "not `theory`"},
      {"plot a.h5 --band '5 kN,4 kN'", 1, "two ascending values"},
      {"plot a.h5 --x cmod --data lab.csv --label a --label b --label c", 1,
       "3 labels for 1 results and their tables"},
      {"plot a.h5 --map damage --data lab.csv", 1, "--data belongs to curves"},
      {"plot a.h5 --x cmod --data nothing.csv", 1, "cannot read `nothing.csv`"},
      {"plot a.h5 --x cmod --data .", 1, "it is a folder"},
  };
  expect_all(w, list, COUNT(list));
  assert_int_equal(
      shell(w, "cp lab.csv lab.png; $P plot a.h5 --x cmod --data lab.png:1,2 -o lab.png"), 1);
  assert_non_null(strstr(w->said, "the picture would overwrite `lab.png`"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
#define IN_WORKPLACE(test)                                                                         \
  cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
      cmocka_unit_test(points_of_straight_lines),
      cmocka_unit_test(what_is_outside_of_a_band),
      cmocka_unit_test(the_first_time_counts),
      cmocka_unit_test(directions),
      IN_WORKPLACE(a_curve_is_compared_with_a_table),
      IN_WORKPLACE(points_bands_and_lines_stand_where_they_should),
      IN_WORKPLACE(units_are_those_of_the_axes),
      IN_WORKPLACE(quasi_static_runs_have_time),
      IN_WORKPLACE(mistakes_of_plot)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
