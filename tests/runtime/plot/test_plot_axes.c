/* Axes of diagrams: ends and steps that read well, units, and where a value stands. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "runtime/plot/plot_axes.h"

static axis set_axis(const char *unit, const char *wanted, double low, double high) {
  axis a = {0};
  char error[200] = "";
  if (!axis_set(&a, "load", unit, wanted, low, high, error, sizeof error)) fail_msg("%s", error);
  return a;
}

/* Ends are whole steps around the values, a step is 1, 2 or 5 times a power of ten, and the range holds 5 to 12.5 of them, so
 * that whole ones are 5 to 14. */
static void axes_hold_their_values_in_whole_steps(void **state) {
  (void)state;
  for (int k = 0; k < 400; k++) {
    const double low = sin(1.3 * k) * pow(10, k % 7 - 3), high = low + fabs(cos(2.1 * k)) + 1e-3;
    const axis a = set_axis("1", NULL, low, high);
    const double steps = (a.high - a.low) / a.step, range = high - low;
    assert_true(a.low <= low * a.factor + 3e-3 * range * a.factor);
    assert_true(a.high >= high * a.factor - 3e-3 * range * a.factor);
    if (!(fabs(steps - round(steps)) < 1e-9 && steps > 4.9 && steps < 14.1))
      fail_msg("%g steps from %g to %g", steps, low, high);
    assert_true(fabs(a.low / a.step - round(a.low / a.step)) < 1e-6);
    const double lead = a.step / pow(10, floor(log10(a.step) + 1e-9));
    assert_true(fabs(lead - 1) < 1e-9 || fabs(lead - 2) < 1e-9 || fabs(lead - 5) < 1e-9);
  }
}

/* Its ends lie on the frame, and places between them are even; y goes up, pixels go down. */
static void values_stand_in_proportion(void **state) {
  (void)state;
  const axis a = set_axis("m", "mm", -0.004, 0.016);
  assert_string_equal(a.unit_text, "mm");
  assert_true(fabs(a.factor - 1000) < 1e-9);
  const double low = a.low / a.factor, high = a.high / a.factor;
  assert_true(fabs(axis_along_x(&a, low) - DIAGRAM_LEFT) < 1e-9);
  assert_true(fabs(axis_along_x(&a, high) - DIAGRAM_RIGHT) < 1e-9);
  assert_true(fabs(axis_along_y(&a, low) - DIAGRAM_BOTTOM) < 1e-9);
  assert_true(fabs(axis_along_y(&a, high) - DIAGRAM_TOP) < 1e-9);
  assert_true(fabs(axis_along_y(&a, 0.5 * (low + high)) - 0.5 * (DIAGRAM_TOP + DIAGRAM_BOTTOM)) <
              1e-9);
}

static void units_that_read_well_are_chosen(void **state) {
  (void)state;
  assert_string_equal(set_axis("m", NULL, 0, 3e-3).unit_text, "mm");
  assert_string_equal(set_axis("N", NULL, 0, 5e4).unit_text, "kN");
  assert_string_equal(set_axis("1", NULL, 0, 3e-7).unit_text,
                      "1e-9"); /* a power of ten, for want of one */
  const axis strain = set_axis("1", NULL, 0, 3e-7);
  assert_true(fabs(strain.factor / 1e9 - 1) < 1e-12 && strain.high < 1000);
}

/* Zero belongs to an axis that begins near it, and an end that is not seen beyond zero is none. */
static void zero_is_an_end_where_it_is_near(void **state) {
  (void)state;
  assert_true(set_axis("1", NULL, 0.2, 1).low == 0);
  assert_true(set_axis("1", NULL, 0.8, 1).low > 0.5);
  assert_true(set_axis("1", NULL, -1e-4, 1).low == 0);
  assert_true(set_axis("1", NULL, -1, 1e-4).high == 0);
}

static void one_value_has_an_axis(void **state) {
  (void)state;
  const axis zero = set_axis("1", NULL, 0, 0), five = set_axis("1", NULL, 5, 5);
  assert_true(zero.low == 0 && zero.high >= 1);
  assert_true(five.low <= 5 && five.high > 5);
}

static void what_cannot_be_shown_is_told(void **state) {
  (void)state;
  axis a;
  char error[200];
  assert_false(axis_set(&a, "load", "N", "mm", 0, 1, error, sizeof error));
  assert_string_equal(error, "`load` is in N; it cannot be shown in `mm`");
  assert_false(axis_set(&a, "load", "N", "bananas", 0, 1, error, sizeof error));
  assert_false(axis_set(&a, "load", "N", NULL, INFINITY, -INFINITY, error, sizeof error));
  assert_string_equal(error, "`load` holds no finite value to draw");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(axes_hold_their_values_in_whole_steps),
      cmocka_unit_test(values_stand_in_proportion),
      cmocka_unit_test(units_that_read_well_are_chosen),
      cmocka_unit_test(zero_is_an_end_where_it_is_near),
      cmocka_unit_test(one_value_has_an_axis),
      cmocka_unit_test(what_cannot_be_shown_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
