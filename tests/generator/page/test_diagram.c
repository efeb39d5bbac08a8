/* Curves as SVG: a needle among many samples is seen, a gap is one, areas lie between their curves;
   names are text. */
#define _GNU_SOURCE
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generator/page/diagram.h"

enum { MANY = 200000 };

static char *drawn(const diagram *d, bool expected) {
  char *text = NULL;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  assert_int_equal(diagram_svg(out, d), expected);
  fclose(out);
  return text;
}

static diagram of(const diagram_curve *curves, int count) {
  return (diagram){.title = "t",
                   .x_name = "x",
                   .x_unit = "1",
                   .y_name = "y",
                   .y_unit = "1",
                   .curves = curves,
                   .count = count};
}

static int occurrences(const char *text, const char *what) {
  int count = 0;
  for (const char *at = text; (at = strstr(at, what)); at++)
    count++;
  return count;
}

/* Of the diagram's frame: left 120, right 1160, top 70, bottom 705. */
static void needles_are_seen(void **state) {
  (void)state;
  static double x[MANY], y[MANY];
  for (long k = 0; k < MANY; k++) {
    x[k] = (double)k / (MANY - 1);
    y[k] = 0.25 + 0.05 * (double)(k % 7) / 6;
  }
  y[123456] = 1;
  y[50000] = 0;
  const diagram_curve curve = {.x = x, .y = y, .count = MANY};
  const diagram d = of(&curve, 1);
  char *text = drawn(&d, true), needle[40];
  assert_true(strlen(text) < 80000); /* four points of 11 characters in each of 1040 columns */
  snprintf(needle, sizeof needle, "L%.1f 70.0L", 120 + 1040 * x[123456]);
  assert_int_equal(occurrences(text, needle), 1);
  snprintf(needle, sizeof needle, "L%.1f 705.0L", 120 + 1040 * x[50000]);
  assert_int_equal(occurrences(text, needle), 1);
  assert_non_null(strstr(text, "d=\"M120.0 "));
  free(text);
}

static void gaps_are_gaps(void **state) {
  (void)state;
  const double x[] = {0, 0.25, 0.5, 0.75, 1}, y[] = {0, 1, NAN, 1, 0};
  const diagram_curve curve = {.x = x, .y = y, .count = 5};
  const diagram d = of(&curve, 1);
  char *text = drawn(&d, true);
  assert_non_null(strstr(text, "d=\"M120.0 705.0L380.0 70.0M900.0 70.0L1160.0 705.0\""));
  free(text);
}

/* Two breaks: nothing stands between 0, 1 and 2; other values do where they are no counts. */
static void counts_have_whole_ticks(void **state) {
  (void)state;
  const double x[] = {0, 1, 2}, y[] = {0, 1, 2}, half[] = {0, 1.5, 2};
  const diagram_curve curve = {.x = x, .y = y, .count = 3},
                      other = {.x = half, .y = half, .count = 3};
  const diagram d = of(&curve, 1), e = of(&other, 1);
  char *text = drawn(&d, true);
  assert_null(strstr(text, ">0.4</text>"));
  assert_int_equal(occurrences(text, ">1</text>"), 2);
  free(text);
  text = drawn(&e, true);
  assert_int_equal(occurrences(text, ">0.4</text>"), 2);
  free(text);
}

/* The axis' name is to the left of the longest number, which has that many characters; letters are
   30 high, digits 17 wide. */
static void name_leaves_room(const double *y, int characters) {
  const double x[] = {0, 1};
  const diagram_curve curve = {.x = x, .y = y, .count = 2};
  const diagram d = of(&curve, 1);
  char *text = drawn(&d, true), seen[20000];
  snprintf(seen, sizeof seen, "%s", text);
  free(text);
  const char *name = strstr(seen, "rotate(-90 "), *view = strstr(seen, "viewBox=");
  double at = NAN, left = NAN;
  if (name) assert_int_equal(sscanf(name, "rotate(-90 %lf", &at), 1);
  if (view) assert_int_equal(sscanf(view, "viewBox=\"%lf", &left), 1);
  assert_true(at - 30 >= left);
  assert_true(at + 10 <= 120 - 14 - 17 * characters);
}

static void names_leave_room_for_numbers(void **state) {
  (void)state;
  const double small[] = {0, 1}, large[] = {-12000, -20000};
  name_leaves_room(small, 3); /* 0.2 */
  name_leaves_room(large, 6); /* -20000 */
}

static void areas_lie_on_each_other(void **state) {
  (void)state;
  const double x[] = {0, 1}, first[] = {0, 0.5}, second[] = {0, 1};
  const diagram_curve curves[] = {{.x = x, .y = first, .count = 2},
                                  {.x = x, .y = second, .count = 2, .ink = 1}};
  diagram d = of(curves, 2);
  d.stacked = true;
  char *text = drawn(&d, true);
  assert_non_null(
      strstr(text, "area ink0\" d=\"M120.0 705.0L1160.0 387.5L1160.0 705.0L120.0 705.0Z"));
  assert_non_null(
      strstr(text, "area ink1\" d=\"M120.0 705.0L1160.0 70.0L1160.0 387.5L120.0 705.0Z"));
  free(text);
}

static void nothing_is_not_drawn(void **state) {
  (void)state;
  const double x[] = {0, 1}, y[] = {NAN, INFINITY};
  const diagram_curve curve = {.x = x, .y = y, .count = 2};
  const diagram d = of(&curve, 1);
  char *text = drawn(&d, false);
  assert_string_equal(text, "");
  free(text);
}

static void names_are_text(void **state) {
  (void)state;
  const double x[] = {0, 1};
  const diagram_curve curve = {.x = x, .y = x, .count = 2, .series = "a\"b<c>", .of = "a"};
  diagram d = of(&curve, 1);
  d.title = "<script>";
  d.y_name = "a\"b<c>";
  d.over = "";
  char *text = drawn(&d, true);
  assert_null(strstr(text, "<c>"));
  assert_null(strstr(text, "<script>"));
  assert_non_null(strstr(text, "data-series=\"0:a:a&quot;b&lt;c&gt;;\""));
  free(text);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(needles_are_seen),        cmocka_unit_test(gaps_are_gaps),
      cmocka_unit_test(counts_have_whole_ticks), cmocka_unit_test(names_leave_room_for_numbers),
      cmocka_unit_test(areas_lie_on_each_other), cmocka_unit_test(nothing_is_not_drawn),
      cmocka_unit_test(names_are_text),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
