/* Studies of the examples: a strength with its bracket, answers that converge and one that cannot,
   a parameter back from the program's own curve. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "tests/dsl/json_valid.h"
#include "tests/generator/command_tools.h"

static void is_near(double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance))
    fail_msg("%.9g is not %.9g +- %.2g", value, expected, tolerance);
}

#define EXAMPLES SOURCE_DIR "/examples/"

static char *said; /* the document of the last study */

/* `perilat study ... --json` ends with the status. */
static void study(workplace *w, int status, const char *arguments) {
  size_t length;
  const int found = shell(w, "$P study %s --json > document", arguments);
  free(said);
  said = read_bytes(w, "document", &length);
  if (found != status || !json_is_valid(said)) show_failure(w, arguments, found, status, "");
  assert_int_equal(found, status);
  assert_true(json_is_valid(said));
}

/* The number of the last key of that name, which is one of the object itself; NaN for null. */
static double number(const char *key) {
  char quoted[100];
  const char *last = NULL;
  snprintf(quoted, sizeof quoted, "\n  \"%s\": ", key);
  for (const char *at = said; (at = strstr(at, quoted)); at++)
    last = at;
  if (!last) fail_msg("no `%s` in %s", key, said);
  last += strlen(quoted);
  return strncmp(last, "null", 4) == 0 ? NAN : strtod(last, NULL);
}

/* FORMULAS of the source say 42 to 44 kN/m; the page of the example 42 borne and 43 not. */
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

/* Theory says f_t. The load has no limit yet at these sizes: its width hangs on the rows that fit. */
static void the_strength_of_a_prism_converges(void **state) {
  workplace *w = *state;
  static const char prism[] = EXAMPLES
      "tension/strength.nml --set relaxation.increments=96 --vary lattice.rotation=0,15,30 --vary "
      "'lattice.spacing=20,10,5 mm' --converge spacing --x displacement --y";
  char arguments[1000];
  snprintf(arguments, sizeof arguments, "%s stress", prism);
  study(w, 0, arguments);
  is_near(number("order"), 1, 0.4);
  is_near(number("value"), 2.6168e6, number("error"));
  is_near(number("value"), 2.6168e6, 0.03 * 2.6168e6);
  assert_true(number("error") < 0.1 * 2.6168e6);
  snprintf(arguments, sizeof arguments, "%s load", prism);
  study(w, 2, arguments);
  assert_true(isnan(number("order")) || number("order") < 0.5);
  assert_true(isnan(number("value")) && isnan(number("error")));
  assert_non_null(strstr(said, "\"converged\": false"));
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
  const struct CMUnitTest tests[] = {
      WITH(strength_of_the_plain_beam),   WITH(one_end_alone),
      WITH(strength_of_the_key_alone),    WITH(d3_does_not_converge),
      WITH(the_step_converges),           WITH(the_strength_of_a_prism_converges),
      WITH(parameter_back_from_its_curve)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
