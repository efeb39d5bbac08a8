/* perilat run --profile: all parts are named, and what is measured adds up to the run. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <unistd.h>

#include "runtime/simulation/profile.h"
#include "tests/generator/command_tools.h"

/* Percent of the run that the line of this part says. */
static double share(const workplace *w, const char *name) {
  char begin[80];
  double percent = -1, seconds = -1;
  snprintf(begin, sizeof begin, "\n    %-22s ", name);
  const char *line = strstr(w->said, begin);
  if (!line) fail_msg("no part `%s` in:\n%s", name, w->said);
  assert_int_equal(sscanf(line + strlen(begin), "%lf %% %lf s\n", &percent, &seconds), 2);
  assert_true(percent >= 0 && seconds >= 0);
  return percent;
}

/* Samples, steps and frames in all; what is in no part (opening the team of threads, the bar) is
   little. */
static void parts_add_up_to_the_run(void **state) {
  workplace *w = *state;
  for (int threads = 1; threads <= 2; threads++) {
    char command[200];
    snprintf(command, sizeof command,
             "run beam.nml --profile --threads %d --set simulation.end_time='20 ms'", threads);
    expect(w, command, 0, "  profile    ");
    double sum = 0;
    for (int k = 0; k < PROFILE_PART_COUNT; k++)
      sum += share(w, profile_names[k]);
    if (!(sum > 80 && sum < 101)) fail_msg("%g %% in\n%s", sum, w->said);
    const double rest = share(w, "rest");
    assert_true(sum + rest > 99 && sum + rest < 101); /* percent are rounded */
    assert_true(share(w, "law") > 1 && share(w, "moving particles") > 0.1);
    assert_non_null(strstr(w->said, "    a particle's step: "));
    assert_non_null(strstr(w->said, "    limited by "));
#ifdef _SC_LEVEL2_CACHE_SIZE
    if (sysconf(_SC_LEVEL2_CACHE_SIZE) >= 1 << 20) /* in which the beam stays */
      assert_null(strstr(w->said, "limited by memory"));
#endif
  }
}

/* Two displacements and a rotation, their velocities, and the damage of three bonds are read and
   written: 8 * 2 (6 + 3) bytes. */
static void bytes_are_those_of_the_state(void **state) {
  workplace *w = *state;
  expect(w, "run beam.nml --profile", 0, " ns, 144 bytes, ");
}

static void laws_of_families_are_told_pass_by_pass(void **state) {
  workplace *w = *state;
  expect(
      w,
      "run beam.nml --profile --set material.model=splm_elastic --set simulation.end_time='1 ms'",
      0, "law, pass 1 of ");
  double sum = share(w, "law, between passes");
  for (int k = 0; k < PROFILE_PART_COUNT; k++)
    sum += k == PROFILE_LAW ? 0 : share(w, profile_names[k]);
  int passes = 0;
  assert_int_equal(sscanf(strstr(w->said, "law, pass 1 of "), "law, pass 1 of %d", &passes), 1);
  for (int k = 1; k <= passes; k++) {
    char name[40];
    snprintf(name, sizeof name, "law, pass %d of %d", k, passes);
    sum += share(w, name);
  }
  if (!(sum > 80 && sum < 101)) fail_msg("%g %% in\n%s", sum, w->said);
  sum += share(w, "rest");
  if (!(sum > 99 && sum < 101)) fail_msg("%g %% in\n%s", sum, w->said);
}

static void without_the_option_nothing_is_said(void **state) {
  workplace *w = *state;
  expect(w, "run beam.nml", 0, "steps/s");
  assert_null(strstr(w->said, "profile"));
}

#define ONE(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)

int main(void) {
  const struct CMUnitTest tests[] = {
      ONE(parts_add_up_to_the_run),
      ONE(bytes_are_those_of_the_state),
      ONE(laws_of_families_are_told_pass_by_pass),
      ONE(without_the_option_nothing_is_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
