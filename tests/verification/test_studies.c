/* Studies of the examples: answers that converge and one that cannot, a parameter back from the
   program's own curve. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "tests/verification/study_said.h"

/* Its parameters belong to a spacing: another spacing is another material. */
static void d3_does_not_converge(void **state) {
  workplace *w = *state;
  study(w, 2,
        EXAMPLES "notched_beam/d3_s6.35.nml --vary 'lattice.spacing=25.4,12.7,6.35 mm' --converge "
                 "lattice.spacing --x cmod");
  assert_true(isnan(number("order")));
  assert_true(isnan(number("value")));
  assert_true(isnan(number("error")));
  assert_non_null(strstr(said, "work of fracture is from 120.9 to 483.4 N/m"));
}

/* The scheme is of second order, and what a much smaller step gives lies within the bar. */
static void the_step_converges(void **state) {
  workplace *w = *state;
  static const char wave[] = EXAMPLES
      "wave_in_a_bar/pmb.nml --set simulation.end_time='0.32 ms' --set output.frames=1 --y "
      "energy/kinetic --of last";
  char arguments[1000];
  snprintf(arguments, sizeof arguments,
           "%s --converge step_safety --vary simulation.step_safety=0.8,0.4,0.2", wave);
  study(w, 0, arguments);
  const double order = number("order"), value = number("value"), error = number("error");
  is_near(order, 2, 0.1);
  assert_true(error < 1e-3 * value);
  snprintf(arguments, sizeof arguments, "%s --vary simulation.step_safety=0.1 -o finer", wave);
  study(w, 0, arguments);
  const char *last = said;
  assert_non_null(last);
  last = strstr(last, "\"energy/kinetic last\": ");
  assert_non_null(last);
  is_near(strtod(last + strlen("\"energy/kinetic last\": "), NULL), value, error);
}

/* From 1.5e-4 back to the 1.18e-4 of its own curve, within 1 %. */
static void parameter_back_from_its_curve(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "$P run " EXAMPLES "notched_beam/d3_s6.35.nml && $P export d3_s6.35.h5 "
                            "--history cmod --history load -o d3.csv"),
                   0);
  study(w, 0,
        EXAMPLES "notched_beam/d3_s6.35.nml --set material.S_t=1.5e-4 --fit "
                 "material.S_t=1e-4..2e-4 --to d3.csv --x cmod --y load");
  const char *value = strstr(said, "\"value\": ");
  assert_non_null(value);
  is_near(strtod(value + 9, NULL), 1.18e-4, 0.01 * 1.18e-4);
}

int main(void) {
#define WITH(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {WITH(d3_does_not_converge), WITH(the_step_converges),
                                     WITH(parameter_back_from_its_curve)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
