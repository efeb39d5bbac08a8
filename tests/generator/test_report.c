/* What the command says of a run, and what a map says of a body: increments in place of times that mean nothing, signs,
   axes of space. */
#define _GNU_SOURCE
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/plot_frame.h"
#include "tests/generator/command_tools.h"

/* A beam pushed down: the load is negative where nothing turns it round. */
static const char quiet[] =
    "&simulation  title = 'quiet, small'  end_time = 1  /\n"
    "&relaxation  increments = 8  tolerance = 1e-3  /\n" SMALL_BEAM
    "&drive       region = 'loader'  component = 'y'  displacement = '-1 um'  /\n"
    "&monitor     name = 'load'  kind = 'reaction'  region = 'loader'  component = 'y'  /\n"
    "&monitor     name = 'moved'  kind = 'displacement'  region = 'loader'  component = 'y'  /\n"
    "&output      result = 'quiet.h5'  frames = 4  /\n";

static void quasi_static_runs_count_increments(void **state) {
  workplace *w = *state;
  write_text(w, "quiet.nml", quiet);
  expect(w, "run quiet.nml", 0,
         "increments 8, quasi-static, each until the unbalanced force is 0.001 of the reactions or "
         "loads, "
         "or for 100000 steps\n");
  assert_null(strstr(w->said, " ms"));
  assert_null(strstr(w->said, "without balance"));
  assert_non_null(strstr(w->said, "moved      largest -1e-06 m at increment 8 of 8\n"));
  assert_non_null(strstr(w->said, "load       largest -"));
  assert_non_null(strstr(w->said, "100 %  increment 8 of 8, load -"));
  assert_non_null(strstr(w->said, "increments 8, in the mean "));
  expect(w, "run quiet.nml --set relaxation.most_steps=20", 0,
         "8 of them without balance after 20 steps\n");
  write_text(w, "stop.nml", quiet);
  assert_int_equal(shell(w, "echo \"&stop monitor = 'moved' above = 0.4e-6 /\" >> stop.nml"), 0);
  expect(w, "run stop.nml", 0, "ended early at increment 4 of 8: moved was above 4e-07\n");
}

static void dynamic_runs_have_times(void **state) {
  workplace *w = *state;
  expect(w, "run beam.nml --set monitor.scale=1", 0, "load       largest -");
  assert_non_null(strstr(w->said, "time       1 ms in "));
  assert_non_null(strstr(w->said, " N at t = "));
  assert_null(strstr(w->said, "increment"));
}

static void read_map(const workplace *w, const char *name, const plot_map_options *o,
                     plot_frame *frame) {
  char error[1000];
  if (!plot_frame_read(frame, in_workplace(w, name), o, error, sizeof error)) fail_msg("%s", error);
}

static void maps_know_their_increment(void **state) {
  workplace *w = *state;
  plot_map_options o = {.field = "damage", .component = -1, .factor = 1, .slice_axis = -1};
  plot_frame frame;
  write_text(w, "quiet.nml", quiet);
  expect(w, "run quiet.nml", 0, "written");
  for (long k = 0; k <= 4; k++) {
    o.frame = k;
    read_map(w, "quiet.h5", &o, &frame);
    assert_int_equal(frame.increment, 2 * k);
    plot_frame_free(&frame);
  }
  expect(w, "run beam.nml", 0, "written");
  read_map(w, "beam.h5", &o, &frame);
  assert_int_equal(frame.increment, -1);
  assert_string_equal(frame.extents, "");
  plot_frame_free(&frame);
  expect(w, "plot beam.h5 quiet.h5 --x time", 1, "holds `time` in another unit (1)");
  expect(w, "plot beam.h5 quiet.h5 --x energy/external", 0, "written beam_load.png");
}

static const char block[] =
    "&simulation  title = 'block'  end_time = '1 us'  /\n"
    "&lattice     name = 'c'  kind = 'cubic'  spacing = '10 mm'  shells = 2  /\n"
    "&material    lattice = 'c'  model = 'splm_elastic'  /\n"
    "&body        lattice = 'c'  shape = 'box'  corner = 0, 0, 0  size = '20 mm', '30 mm', '50 mm' "
    " /\n"
    "&output      result = 'block.h5'  frames = 1  fields = 'displacement'  /\n";

/* Lengths along x, y and z in a picture without perspective: the squares sum up to 1 in either direction. */
static void maps_of_space_have_axes(void **state) {
  workplace *w = *state;
  static const int across[3] = {1, 0, 0}, up[3] = {2, 2, 1};
  plot_map_options o = {
      .field = "displacement", .frame = -1, .component = -1, .factor = 1, .slice_axis = -1};
  plot_frame frame;
  write_text(w, "block.nml", block);
  expect(w, "run block.nml", 0, "written");
  for (int axis = -1; axis < 3; axis++) {
    o.slice_axis = axis;
    o.slice_at = 0.01;
    read_map(w, "block.h5", &o, &frame);
    assert_string_equal(frame.extents, "x 0 to 20 mm, y 0 to 30 mm, z 0 to 50 mm");
    double square[2] = {0, 0}, product = 0;
    for (int c = 0; c < 3; c++) {
      for (int k = 0; k < 2; k++)
        square[k] += frame.axes[c][k] * frame.axes[c][k];
      product += frame.axes[c][0] * frame.axes[c][1];
    }
    assert_true(fabs(square[0] - 1) < 1e-12 && fabs(square[1] - 1) < 1e-12 &&
                fabs(product) < 1e-12);
    if (axis >= 0) assert_true(frame.axes[across[axis]][0] == 1 && frame.axes[up[axis]][1] == 1);
    plot_frame_free(&frame);
  }
  expect(w, "plot block.h5 --map displacement", 0, "written block_displacement.png");
}

/* Five rows of D3 are cut, nine are left (runtime/README.md); edges that lack bonds are named,
   others are not. */
static void what_sites_make_of_shapes(void **state) {
  workplace *w = *state;
  expect(
      w, "check " SOURCE_DIR "/examples/notched_beam/d3_s6.35.nml", 0,
      "\n  notch      25.4 mm deep as drawn, 27.5 mm to the first bond left; ligament 49.49 mm\n");
  assert_non_null(strstr(w->said,
                         "\n  body       held in a uniform strain E = 28.96 GPa along x "
                         "(-3.5 %), E = 29.55 GPa along y (-1.5 %): edges and notches lack "
                         "bonds\n"));
  write_text(w, "strip.nml",
             "&simulation  end_time = '1 ms'  /\n"
             "&lattice  name = 'l'  kind = 'hexagonal'  spacing = '10 mm'  thickness = '10 mm'  /\n"
             "&material  lattice = 'l'  model = 'elastic_central'  /\n"
             "&body  lattice = 'l'  shape = 'rectangle'  corner = 0, 0  size = 1, 0.0607  /\n");
  expect(w, "check strip.nml", 0, "no errors");
  assert_null(strstr(w->said, "  body "));
  expect(w, "check strip.nml --set lattice.rotation=15", 0, "GPa along x (-5.4 %)");
  shell(w, "for k in 1 2 3 4 5 6 7 8 9 10; do echo \"&notch lattice = 'l' shape = 'segment' from = "
           "0.0${k}1, 0.01 to = 0.0${k}1, 0.05 /\"; done >> strip.nml");
  expect(w, "check strip.nml", 0, "  notch 1    40 mm long as drawn, ");
  assert_non_null(strstr(w->said, "\n             and 2 more\n"));
}

int main(void) {
#define ONE(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {
      ONE(quasi_static_runs_count_increments), ONE(dynamic_runs_have_times),
      ONE(maps_know_their_increment),          ONE(maps_of_space_have_axes),
      ONE(what_sites_make_of_shapes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
