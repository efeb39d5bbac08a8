/* The strengths of the four beams of examples/reinforced_concrete, by their studies, as their page
   has them. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "generator/kernel/model.h"
#include "tests/dsl/json_valid.h"
#include "tests/generator/command_tools.h"

#include "tests/verification/page.h"

#define PAGE "examples/reinforced_concrete/README.md"

/* The number of the last key of that name. */
static double number(const char *document, const char *key) {
  char quoted[100];
  const char *last = NULL;
  snprintf(quoted, sizeof quoted, "\n  \"%s\": ", key);
  for (const char *at = document; (at = strstr(at, quoted)); at++)
    last = at;
  if (!last) fail_msg("no `%s` in %s", key, document);
  return strtod(last + strlen(quoted), NULL);
}

static void is_near(double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance))
    fail_msg("%.9g is not %.9g +- %.2g", value, expected, tolerance);
}

/* In kN/m: borne and not borne, of the loads; the peak of the twin. */
static void strength(workplace *w, const char *name, const char *loads, double borne,
                     double not_borne, double peak) {
  size_t length;
  char figure[64];
  const int failed = shell(w,
                           "$P study " SOURCE_DIR "/examples/reinforced_concrete/%s_strength.nml "
                           "--strength 'force.per_length=%s kN/m' --json > document",
                           name, loads);
  if (failed) show_failure(w, name, failed, 0, "");
  assert_int_equal(failed, 0);
  char *document = read_bytes(w, "document", &length);
  assert_true(json_is_valid(document));
  is_near(number(document, "lower"), 1e3 * borne, 1e-6);
  is_near(number(document, "upper"), 1e3 * not_borne, 1e-6);
  is_near(number(document, "peak"), 1e3 * peak, 0.005 * 1e3 * peak);
  free(document);
  snprintf(figure, sizeof figure, "| %g, %g |", borne, not_borne);
  page_line_says(PAGE, "| borne, not borne, kN/m |", figure);
}

/* Reference: 42 to 44. */
static void plain_beam(void **state) {
  strength(*state, "plain_beam", "-36..-48:2", 42, 44, 48.2);
}

/* 82 to 85 */
static void one_bar(void **state) {
  strength(*state, "one_bar", "-78..-90:2", 82, 84, 83.2);
}

/* 65 to 70; the range is narrow, as the beams take long. */
static void stirrups_bending(void **state) {
  strength(*state, "stirrups_bending", "-66..-70:2", 68, 70, 77.0);
}

/* 250 to 270 */
static void stirrups_shear(void **state) {
  strength(*state, "stirrups_shear", "-270..-280:10", 270, 280, 308);
}

int main(void) {
#define WITH(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {WITH(plain_beam), WITH(one_bar), WITH(stirrups_bending),
                                     WITH(stirrups_shear)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
