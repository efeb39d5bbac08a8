/* A particle in space that is turned far about several axes at once, at the end of a beam whose
   moments derive from an energy: the work of what drives and holds it, in steps and at rest. */
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

#define BEAM                                                                                       \
  "&lattice name = 'c' kind = 'cubic' spacing = 0.01 origin = 0, 0, 0 /\n"                         \
  "&body lattice = 'c' shape = 'box' corner = 0, 0, 0 size = 0.011, 0.001, 0.001 /\n"              \
  "&material lattice = 'c' model = '" SOURCE_DIR "/models/mplm_space.plm' E = '3 GPa' /\n"         \
  "&region name = 'left' shape = 'point' at = 0, 0, 0 /\n"                                         \
  "&region name = 'right' shape = 'point' at = 0.01, 0, 0 /\n"                                     \
  "&support region = 'left' fix = 'xyz', 'rotation' /\n"                                           \
  "&support region = 'right' fix = 'xyz' /\n"                                                      \
  "&monitor name = 'y' kind = 'displacement' region = 'right' component = 'rotation_y' /\n"        \
  "&monitor name = 'rate' kind = 'velocity' region = 'right' component = 'rotation_y' /\n"         \
  "&monitor name = 'x' kind = 'reaction' region = 'right' component = 'rotation_x' /\n"            \
  "&monitor name = 'z' kind = 'reaction' region = 'right' component = 'rotation_z' /\n"
#define HELD_Y "&support region = 'right' fix = 'rotation_y' /\n"

static double largest_of(result_file *f, const char *name, double *last) {
  char error[512], unit_text[32];
  long count;
  double *values =
             result_read_series(f, name, &count, unit_text, sizeof unit_text, error, sizeof error),
         most = 0;
  if (!values) fail_msg("%s", error);
  for (long k = 0; k < count; k++)
    most = fmax(most, fabs(values[k]));
  *last = values[count - 1];
  free(values);
  return most;
}

static result_file *run_deck(workplace *w, const char *text, const char *options) {
  char error[512];
  write_text(w, "turn.nml", text);
  char *command;
  if (asprintf(&command, "run turn.nml --interpret %s", options) < 0) abort();
  expect(w, command, 0, "written    turn.h5");
  free(command);
  result_file *f = result_read(in_workplace(w, "turn.h5"), error, sizeof error);
  if (!f) fail_msg("%s", error);
  return f;
}

static void expect_rest(workplace *w) {
  char error[512];
  double last;
  result_file *f = result_read(in_workplace(w, "turn.h5"), error, sizeof error);
  if (!f) fail_msg("%s", error);
  largest_of(f, "relaxation_unbalance", &last);
  assert_true(last < 1e-9);
  result_read_close(f);
}

typedef struct turned {
  double imbalance, work;    /* J */
  double y, rate;            /* rad, rad/s; the largest */
  double y_last;             /* rad, at the end */
  double moment_x, moment_z; /* N m, at the end */
} turned;

static turned turn(workplace *w, const char *text, const char *options) {
  turned t;
  double last;
  result_file *f = run_deck(w, text, options);
  t.imbalance = largest_of(f, "energy/imbalance", &last);
  largest_of(f, "energy/external", &t.work);
  t.y = largest_of(f, "y", &t.y_last);
  t.rate = largest_of(f, "rate", &last);
  largest_of(f, "x", &t.moment_x);
  largest_of(f, "z", &t.moment_z);
  result_read_close(f);
  return t;
}

/* First about z, then about x: the imbalance is of the second order in the step. What is held about
   y turns about y all the same, with a moment that does no work. */
static void work_is_that_of_moments(void **state) {
  workplace *w = *state;
  static const char *const third[] = {"", HELD_Y};
  for (int k = 0; k < 2; k++) {
    char *text;
    turned t[3];
    if (asprintf(
            &text,
            "&simulation end_time = 2e-3 /\n" BEAM "%s"
            "&drive region = 'right' component = 'rotation_z' displacement = 0.5 rise = 1e-3 /\n"
            "&drive region = 'right' component = 'rotation_x' displacement = 0.3 start = 8e-4 "
            "rise = 1e-3 /\n&output frames = 0 sample = 1e-5 /\n",
            third[k]) < 0)
      abort();
    for (int n = 0; n < 3; n++) {
      static const char *const steps[] = {"--set simulation.step=1.6e-6",
                                          "--set simulation.step=8e-7",
                                          "--set simulation.step=4e-7"};
      t[n] = turn(w, text, steps[n]);
    }
    print_message("%s about y: imbalance %.1e, %.1e, %.1e of %.4f J; y %.1e, %.1f rad/s\n",
                  k ? "held" : "free", t[0].imbalance, t[1].imbalance, t[2].imbalance, t[2].work,
                  t[2].y, t[2].rate);
    assert_true(t[0].imbalance < 1e-5 * t[0].work);
    assert_true(t[0].imbalance / t[1].imbalance > 3.8 && t[1].imbalance / t[2].imbalance > 3.8);
    if (k) assert_true(t[2].y == 0 && t[2].rate > 1);
    free(text);
  }
}

/* Balance is found with moments about axes along which nothing is held, and reactions at rest are
   those after a slow motion. */
static void a_turned_particle_comes_to_rest(void **state) {
  workplace *w = *state;
  static const char text[] =
      "&simulation end_time = 1 /\n&relaxation increments = 1 tolerance = 1e-9 /\n" BEAM
      "&drive region = 'right' component = 'rotation_z' displacement = 0.5 rise = 1 /\n"
      "&drive region = 'right' component = 'rotation_x' displacement = 0.3 rise = 1 /\n"
      "&output frames = 0 /\n";
  static const char moving[] =
      "&simulation end_time = 2e-3 step = 8e-7 /\n" BEAM HELD_Y
      "&drive region = 'right' component = 'rotation_z' displacement = 0.5 rise = 1e-3 /\n"
      "&drive region = 'right' component = 'rotation_x' displacement = 0.3 rise = 1e-3 /\n"
      "&output frames = 0 sample = 1e-5 /\n";
  const turned rest = turn(w, text, "");
  expect_rest(w);
  const turned moved = turn(w, moving, "");
  print_message("at rest %.6f and %.6f N m, after motion %.6f and %.6f\n", rest.moment_x,
                rest.moment_z, moved.moment_x, moved.moment_z);
  assert_true(fabs(rest.moment_x) > 1 && fabs(rest.moment_z) > 1);
  assert_true(fabs(rest.moment_x - moved.moment_x) < 1e-6 * fabs(rest.moment_x));
  assert_true(fabs(rest.moment_z - moved.moment_z) < 1e-6 * fabs(rest.moment_z));
}

/* Pushed about y while it is held about x and has been turned about z: at rest what holds it bears
   moments about y, too. Then nothing moves or works any more. */
static void a_pushed_particle_comes_to_rest(void **state) {
  workplace *w = *state;
#define PUSHED(end, rise)                                                                          \
  BEAM "&support region = 'right' fix = 'rotation_x' /\n"                                          \
       "&drive region = 'right' component = 'rotation_z' displacement = 0.5 rise = " rise " /\n"   \
       "&force region = 'right' component = 'rotation_y' moment = 20 rise = " rise " /\n"          \
       "&output frames = 0 " end " /\n"
  static const char text[] =
      "&simulation end_time = 1 /\n&relaxation increments = 1 tolerance = 1e-9 /\n" PUSHED("", "1");
  static const char moving[] = "&simulation end_time = 6e-3 step = 8e-7 /\n"
                               "&damping rate = 2e4 /\n" PUSHED("sample = 1e-5", "2e-3");
  const turned rest = turn(w, text, "");
  expect_rest(w);
  const turned moved = turn(w, moving, "");
  print_message("at rest y %.8f, moment %.6f N m; after motion %.8f and %.6f, imbalance %.1e\n",
                rest.y_last, rest.moment_z, moved.y_last, moved.moment_z, moved.imbalance);
  assert_true(rest.y_last > 0.1 && rest.moment_z > 1);
  assert_true(fabs(rest.y_last - moved.y_last) < 1e-8);
  assert_true(fabs(rest.moment_x) < 1e-9 && fabs(moved.moment_x) < 1e-9); /* alike about y and z */
  assert_true(fabs(rest.moment_z / moved.moment_z - 1) < 1e-8);
  assert_true(moved.imbalance < 1e-6 * moved.work);
}

int main(void) {
#define ONE(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {ONE(work_is_that_of_moments),
                                     ONE(a_turned_particle_comes_to_rest),
                                     ONE(a_pushed_particle_comes_to_rest)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
