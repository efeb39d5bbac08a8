/* Pulses along bars in one run of the example's decks: three lattices with three laws, and a chain
   with a joint. The figures that its page prints, and its picture. */
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

/* Highest and lowest of what a station sees, from a time on. */
static void extremes_of(result_file *f, const char *name, double from, double *low, double *high) {
  long count;
  double *time = series_of(f, "time", &count), *v = series_of(f, name, &count);
  *low = *high = 0;
  for (long k = 0; k < count; k++) {
    if (time[k] < from) continue;
    *low = fmin(*low, v[k]);
    *high = fmax(*high, v[k]);
  }
  free(time);
  free(v);
}

static void a_pulse_meets_a_joint(void **state) {
  workplace *w = *state;
  static const struct {
    const char *glue;
    double on, back_low, back_high; /* over the incident peak, as printed */
  } printed[] = {{"30 GPa", 0.3226, -0.6774, 0.0030},
                 {"0.3 GPa", 0.1701, -0.6944, 0.5082},
                 {"0.03 GPa", 0.0279, -0.1476, 0.9256}};
  char error[512], command[512];
  for (int k = 0; k < 3; k++) {
    double none, incident, on, low, high;
    snprintf(command, sizeof command,
             "run '" SOURCE_DIR "/examples/wave_in_a_bar/joint.nml' --set 'material[3].E=%s'",
             printed[k].glue);
    expect(w, command, 0, "1 bond as `bar.concrete-steel`");
    result_file *f = result_read(in_workplace(w, "joint.h5"), error, sizeof error);
    if (!f) fail_msg("%s", error);
    extremes_of(f, "before", 0, &none, &incident); /* no echo is higher */
    extremes_of(f, "before", 0.4e-3, &low, &high);
    extremes_of(f, "behind", 0, &none, &on);
    print_message("glue of %s: %.4f on, %.4f and %.4f back\n", printed[k].glue, on / incident,
                  low / incident, high / incident);
    assert_true(fabs(on / incident - printed[k].on) < 1e-4);
    assert_true(fabs(low / incident - printed[k].back_low) < 1e-4);
    assert_true(fabs(high / incident - printed[k].back_high) < 1e-4);
    result_read_close(f);
  }
}

int main(void) {
#define ONE(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {ONE(pulses_travel_along_three_bars),
                                     ONE(a_pulse_meets_a_joint)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
