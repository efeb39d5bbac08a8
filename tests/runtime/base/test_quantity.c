/* Numbers with units as options give them: "58.88 kN" in SI, and what is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "runtime/base/quantity.h"

static void quantities_are_read_in_si(void **state) {
  (void)state;
  static const struct {
    const char *text, *si_unit;
    double value;
  } cases[] = {{"58.88 kN", "N", 58880},     {"0.128mm", "m", 1.28e-4}, {"0.05", "m", 0.05},
               {"-3e-2 ", "m", -0.03},       {" +.5 MPa", "Pa", 5e5},   {"2 kN m", "N m", 2000},
               {"1 mm^2  ", "m^2", 1e-6},    {"90", "1", 90},           {"7 1/ms", "1/s", 7000},
               {"1e3 kg/m^3", "kg/m^3", 1e3}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    double value = NAN;
    assert_true(quantity_read(cases[k].text, strlen(cases[k].text), cases[k].si_unit, &value));
    assert_true(fabs(value - cases[k].value) <= 4e-16 * fabs(cases[k].value));
  }
}

static void what_is_no_quantity_is_refused(void **state) {
  (void)state;
  static const char *const cases[] = {"",      "kN",  "5 kg",  "5 kn", "5 mm mm", "1e999 N",
                                      "nan N", "inf", "5 kN,", "0x",   "--5 N",   "5 N 6"};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    double value;
    if (quantity_read(cases[k], strlen(cases[k]), "N", &value))
      fail_msg("`%s` is taken as %g N", cases[k], value);
  }
}

/* Only so many bytes belong to it; and a text of more than a hundred is none. */
static void the_length_ends_a_quantity(void **state) {
  (void)state;
  char longer[200];
  double value;
  assert_true(quantity_read("12 mm:rest", 5, "m", &value));
  assert_true(fabs(value - 0.012) < 1e-17);
  assert_true(quantity_read("123", 2, "m", &value) && fabs(value - 12) < 1e-15);
  memset(longer, '1', sizeof longer);
  assert_true(quantity_read(longer, 100, "m", &value));
  assert_false(quantity_read(longer, 101, "m", &value));
}

static void a_quantity_begins_as_a_number(void **state) {
  (void)state;
  assert_true(quantity_begins("5 mm") && quantity_begins(" -.5") && quantity_begins("+3"));
  assert_false(quantity_begins("mm") || quantity_begins("") || quantity_begins("-x") ||
               quantity_begins("e5"));
}

static void times_are_read_at_a_glance(void **state) {
  (void)state;
  char text[TIME_TEXT];
  assert_string_equal(time_text(0, 5, text), "0 ms");
  assert_string_equal(time_text(4.09987654e-3, 5, text), "4.0999 ms");
  assert_string_equal(time_text(1, 6, text), "1000 ms");
  assert_string_equal(time_text(10, 6, text), "10 s");
  assert_string_equal(time_text(3600, 6, text), "1 h");
  assert_string_equal(time_text(2.16e6, 6, text), "600 h");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(quantities_are_read_in_si),
      cmocka_unit_test(what_is_no_quantity_is_refused),
      cmocka_unit_test(the_length_ends_a_quantity),
      cmocka_unit_test(a_quantity_begins_as_a_number),
      cmocka_unit_test(times_are_read_at_a_glance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
