/* The example with three lattices and three laws in one run: the figures that its page prints, its
   picture, and a stop on the way. */
#define _GNU_SOURCE
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/result/result_read.h"
#include "tests/generator/command_tools.h"

static double *series_of(result_file *f, const char *name, long *count) {
  char error[512], unit_text[32];
  double *values =
      result_read_series(f, name, count, unit_text, sizeof unit_text, error, sizeof error);
  if (!values) fail_msg("%s", error);
  return values;
}

/* The pulse's centre of gravity in time, s. */
static double centre_of(result_file *f, const char *station, const char *bar) {
  char name[64];
  long count;
  snprintf(name, sizeof name, "%s_%s", station, bar);
  double *time = series_of(f, "time", &count), *v = series_of(f, name, &count), sum = 0, moment = 0;
  for (long k = 1; k < count; k++) {
    sum += v[k] * (time[k] - time[k - 1]);
    moment += v[k] * time[k] * (time[k] - time[k - 1]);
  }
  free(time);
  free(v);
  return moment / sum;
}

static void pulses_travel_along_three_bars(void **state) {
  workplace *w = *state;
  static const struct {
    const char *bar;
    double speed; /* m/s, as printed */
  } printed[] = {{"square", 3564.1}, {"hexagons", 3250.0}, {"chain", 3280.6}};
  char error[512];
  expect(w, "run '" SOURCE_DIR "/examples/wave_in_a_bar/three.nml'", 0, "written    three.h5");
  result_file *f = result_read(in_workplace(w, "three.h5"), error, sizeof error);
  if (!f) fail_msg("%s", error);
  for (int k = 0; k < 3; k++) {
    const double speed =
        0.4 / (centre_of(f, "far", printed[k].bar) - centre_of(f, "near", printed[k].bar));
    print_message("%s: %.1f m/s\n", printed[k].bar, speed);
    assert_true(fabs(speed - printed[k].speed) < 0.1);
  }
  result_read_close(f);
  expect(w, "plot three.h5 --map velocity --component 0 --frame 8 -o three.png", 0, "written");
  expect(w, "compare three.h5 three.h5", 0, "none differs");
}

int main(void) {
#define ONE(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {ONE(pulses_travel_along_three_bars)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
