/* Strengths of the examples by studies, with their brackets. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "tests/verification/study_said.h"

/* The source says 42 to 44 kN/m; the page of the example 42 borne and 43 not. */
static void strength_of_the_plain_beam(void **state) {
  workplace *w = *state;
  study(w, 0,
        EXAMPLES "reinforced_concrete/plain_beam.nml --strength 'force.per_length=-40..-46:2 kN/m' "
                 "--twin " EXAMPLES "reinforced_concrete/plain_beam_path.nml");
  is_near(number("lower"), 42e3, 1e-6);
  is_near(number("upper"), 44e3, 1e-6);
  is_near(number("peak"), 48.2e3, 0.05e3);
  assert_non_null(strstr(said, "\"unit\": \"N/m\""));
}

/* Where nothing collapses there is no upper end, where the first does no lower one. */
static void one_end_alone(void **state) {
  workplace *w = *state;
  study(w, 2, EXAMPLES "reinforced_concrete/plain_beam.nml --strength 'force.per_length=-5 kN/m'");
  is_near(number("lower"), 5e3, 1e-6);
  assert_true(isnan(number("upper")));
  study(w, 2,
        EXAMPLES "reinforced_concrete/plain_beam.nml --strength force.per_length=-60kN/m -o many");
  assert_true(isnan(number("lower")));
  is_near(number("upper"), 60e3, 1e-6);
}

/* Without loads it looks for them: 42 is borne, 43 not. */
static void strength_of_the_key_alone(void **state) {
  workplace *w = *state;
  study(w, 0,
        EXAMPLES "reinforced_concrete/plain_beam.nml --strength force.per_length --set "
                 "force.per_length='-60 kN/m'");
  const double lower = number("lower"), upper = number("upper");
  assert_true(lower >= 41.5e3 && lower <= 43e3);
  assert_true(upper > lower && upper < 45e3);
  assert_true(upper - lower < 1.3e3);
}

int main(void) {
#define WITH(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {WITH(strength_of_the_plain_beam), WITH(one_end_alone),
                                     WITH(strength_of_the_key_alone)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
