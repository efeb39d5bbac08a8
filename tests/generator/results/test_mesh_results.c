/* A plate with a crack that runs at both ends: what the run leaves of it, however it was run, and
   what is drawn of it. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>

#include "runtime/result/result_find.h"
#include "tests/generator/command_tools.h"

static void run_plate(workplace *w, const char *options, const char *result) {
  assert_int_equal(shell(w,
                         "$P run '" SOURCE_DIR "/tests/clients/mesh.nml' %s --set output.result=%s",
                         options, result),
                   0);
}

static double last_of(result_file *f, const char *series) {
  long count = 0;
  char unit_text[64], error[1024];
  double *v =
      result_read_series(f, series, &count, unit_text, sizeof unit_text, error, sizeof error);
  assert_non_null(v);
  const double last = v[count - 1];
  free(v);
  return last;
}

/* Ends of the path are where the tips are, its length is the history's; nothing stands beyond. */
static void the_path_is_that_of_the_histories(void **state) {
  workplace *w = *state;
  char error[1024];
  long frames = 0, most = 0;
  run_plate(w, "", "a.h5");
  result_file *f = open_result_of(w, "a.h5");
  double *p = result_read_path(f, "slit", &frames, &most, error, sizeof error);
  assert_non_null(p);
  assert_int_equal(frames, 4);
  const double *first = p, *last = p + 2 * most * 3;
  static const double begun[] = {0.0413, 0.0417, 0.0509, 0.0409, 0.0578, 0.0423};
  for (int k = 0; k < 6; k++)
    assert_true(fabs(first[k] - begun[k]) < 1e-15);
  for (long k = 6; k < 2 * most; k++)
    assert_true(isnan(first[k]));
  assert_true(last[0] == last_of(f, "slit/start/x") && last[1] == last_of(f, "slit/start/y"));
  assert_true(last[2 * most - 2] == last_of(f, "slit/x"));
  assert_true(last[2 * most - 1] == last_of(f, "slit/y"));
  assert_int_equal(most, 3 + last_of(f, "slit/segments") + last_of(f, "slit/start/segments"));
  double grown = 0, middle = 0;
  for (long k = 1; k < most; k++)
    grown += hypot(last[2 * k] - last[2 * k - 2], last[2 * k + 1] - last[2 * k - 1]);
  for (int k = 1; k < 3; k++)
    middle += hypot(begun[2 * k] - begun[2 * k - 2], begun[2 * k + 1] - begun[2 * k - 1]);
  const double both = last_of(f, "slit/length") + last_of(f, "slit/start/length");
  assert_true(grown > 1.5 * middle && fabs(grown - (both - middle)) < 1e-12);
  free(p);
  result_read_close(f);
}

static void same_bits_however_it_runs(void **state) {
  workplace *w = *state;
  run_plate(w, "--threads 1", "a.h5");
  run_plate(w, "--threads 2", "b.h5");
  expect(w, "compare a.h5 b.h5", 0, "cracks/slit/points [m]");
  assert_int_equal(shell(w,
                         "$P run '" SOURCE_DIR "/tests/clients/mesh.nml' --set output.result=c.h5 "
                         "--set 'checkpoint.interval=0.001 s' & run=$!; "
                         "until test -e c.h5.checkpoint || test -e c.h5; do sleep 0.01; done; "
                         "kill -KILL $run; wait $run; rm -f c.h5; test -e c.h5.frames"),
                   0);
  run_plate(w, "--set 'checkpoint.interval=0.001 s' --resume", "c.h5");
  assert_non_null(strstr(w->said, "resumed at"));
  expect(w, "compare a.h5 c.h5", 0, "same");
  run_plate(w, "--set 'crack.v_0=200 m/s'", "d.h5");
  expect(w, "compare a.h5 d.h5", 2, "* cracks/slit/points [m]");
}

static void it_is_told(void **state) {
  workplace *w = *state;
  run_plate(w, "", "a.h5");
  expect(w, "info a.h5", 0, "Crack `slit`: from (");
  assert_non_null(strstr(w->said, " nodes, 0 bonds, "));
  assert_non_null(strstr(w->said, "mm long; 16.674 mm in the first"));
  expect(w, "export a.h5 --cracks slit", 0,
         "frame [1],time [s],x [m],y "
         "[m]\n0,0,0.041299999999999996,0.0417\n0,0,0.0509,0.0409\n0,0,0.0578,0.0423\n1,");
  expect(w, "export a.h5 --cracks slot", 1,
         "no crack, and no cracks of a monitor, `slot`; it has `slit`");
  expect(w, "run '" SOURCE_DIR "/tests/clients/mesh.nml' --set monitor.name=slit", 1,
         "cannot both be called `slit`");
  expect(w, "run '" SOURCE_DIR "/tests/clients/mesh.nml' --set crack.name=energy", 1,
         "a crack cannot be called `energy`");
}

/* Width and height of a PNG. */
static void size_of_png(const workplace *w, const char *name, long size[2]) {
  size_t length;
  unsigned char *bytes = (unsigned char *)read_bytes(w, name, &length);
  assert_true(length > 24);
  for (int k = 0; k < 2; k++)
    size[k] = (long)bytes[16 + 4 * k] << 24 | (long)bytes[17 + 4 * k] << 16 |
              (long)bytes[18 + 4 * k] << 8 | (long)bytes[19 + 4 * k];
  free(bytes);
}

static bool same_files(const workplace *w, const char *a, const char *b) {
  size_t sizes[2];
  char *texts[2] = {read_bytes(w, a, &sizes[0]), read_bytes(w, b, &sizes[1])};
  const bool same = sizes[0] == sizes[1] && memcmp(texts[0], texts[1], sizes[0]) == 0;
  free(texts[0]);
  free(texts[1]);
  return same;
}

static void it_is_drawn(void **state) {
  workplace *w = *state;
  long size[2];
  run_plate(w, "", "a.h5");
  expect(w, "plot a.h5 --map stress --component yy -o a.png", 0, "written a.png");
  expect(w, "plot a.h5 --map stress_yy -o b.png", 0, "written b.png");
  assert_true(same_files(w, "a.png", "b.png")); /* two names of one field */
  expect(w, "plot a.h5 --map stress --component principal -o b.png", 0, "written b.png");
  assert_false(same_files(w, "a.png", "b.png"));
  expect(w, "plot a.h5 --map stress --component yy --frame 1 -o b.png", 0, "written b.png");
  assert_false(same_files(w, "a.png", "b.png"));
  expect(w, "plot a.h5 --map stress --component yy --range '-1 MPa,9 MPa' -o b.svg", 0, "written");
  expect(w, "plot a.h5 --map stress --component xy --contours 9 -o c.pdf", 0, "written c.pdf");
  expect(w, "plot a.h5 --map velocity --component y --frames 1,2,3 -o d.png", 0, "written d.png");
  expect(w, "plot a.h5 --map stress --component yy --mark 'stress_yy > 9 MPa' -o d.png", 0, "");
  expect(w, "plot a.h5 --cracks -o e.png", 0, "written e.png");
  size_of_png(w, "e.png", size);
  assert_int_equal(size[0], 80 + 775 + 60 + 46 + 220); /* plate 100 by 80 mm, 620 high; legend */
  expect(w, "plot a.h5 a.h5 --cracks --label one --label two --title both", 0, "a_cracks.png");
  static const struct {
    const char *line, *wanted;
  } mistakes[] = {
      {"plot a.h5 --map stress", "`stress` is a tensor: give --component xx, yy, xy or principal"},
      {"plot a.h5 --map stress --component zz", "is a tensor"},
      {"plot a.h5 --map displacement --component yy", "it is no tensor"},
      {"plot a.h5 --map strain --component yy",
       "has no field `strain`; add 'strain' to `fields` in the deck's `&output` and run again; "},
      {"plot a.h5 --map strain",
       "has no field `strain`; add 'strain' to `fields` in the deck's `&output` and run again; "},
      {"plot a.h5 --map damage", "is of a mesh, which has no damage"},
      {"plot a.h5 --map stress --component yy --range 3", "--range needs two ascending values"},
      {"plot a.h5 --map stress --component yy --range '3 MPa,1 MPa'", "two ascending values"},
      {"plot a.h5 --map stress --component yy --range '1 m,2 m'", "in a unit of `Pa`"},
      {"plot a.h5 --map stress --component yy --frame 0 --contours 5", "the same everywhere"},
      {"plot a.h5 --map stress --component yy --contours 0", "from 1 to 24"},
      {"plot a.h5 --cracks --x time", "--x does not belong to --cracks"},
      {"plot a.h5 --cracks --map stress", "give one of them"},
      {"plot a.h5 --cracks --frame 9", "there is no frame 9"},
      {"plot a.h5 --cracks --label a --label b", "2 labels for 1 results"},
      {"plot a.h5 --frame 1", "--frame belongs to maps"},
  };
  for (size_t k = 0; k < sizeof mistakes / sizeof *mistakes; k++)
    expect(w, mistakes[k].line, 1, mistakes[k].wanted);
  expect(w, "run beam.nml", 0, "written");
  expect(w, "plot beam.h5 --cracks", 1, "holds no cracks of a mesh");
  expect(w, "plot beam.h5 --map displacement --contours 5", 1, "--contours is of meshes");
}

/* What `fields` leaves out is told where it is missed, but nothing that nobody can store. */
static void fields_that_were_not_stored_are_told(void **state) {
  workplace *w = *state;
  expect(w, "new arm --kind continuum", 0, "written arm.plm");
  expect(w, "run arm.nml --set \"output.fields='velocity'\"", 0, "written");
  expect(w, "info arm.h5", 0, "Frames hold: displacement, velocity\n");
  expect(w, "plot arm.h5 --map velocity --component x -o arm.png", 0, "written arm.png");
  expect(w, "plot arm.h5 --map mises", 1,
         "has no field `mises`; add 'mises' to `fields` in the deck's `&output` and run again; ");
  expect(w, "plot arm.h5 --map mean", 1, "has no field `mean`; fields of particles: ");
  assert_null(strstr(w->said, "&output"));
}

/* The mesh of the deck has a node each 5 mm. */
static void nodes_are_called_so(void **state) {
  workplace *w = *state;
  expect(w, "new arm --kind continuum", 0, "written arm.plm");
  expect(w, "run arm.nml --set 'drive.velocity=1e12 m/s'", 2, " at node ");
  assert_null(strstr(w->said, "particle"));
  assert_int_equal(shell(w, "sed -i \"s/'segment'  from = '80 mm', 0  to = '80 mm', '40 mm'/"
                            "'rectangle'  corner = '77 mm', '11 mm'  size = '2 mm', '1 mm'/\" "
                            "arm.nml"),
                   0);
  expect(w, "check arm.nml", 1, "region `right` holds no node");
  assert_non_null(strstr(w->said, "the nodes of `plate` lie in x = 0 .. 80 mm, y = 0 .. 40 mm; the "
                                  "nearest stands at (80, 10) mm"));
  write_text(w, "none.nml", "&simulation  end_time = '1 ms'  /\n");
  expect(w, "check none.nml", 1, "neither `&lattice` nor `&mesh`");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(the_path_is_that_of_the_histories, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(same_bits_however_it_runs, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(fields_that_were_not_stored_are_told, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(nodes_are_called_so, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(it_is_told, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(it_is_drawn, set_up_workplace, tear_down_workplace)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
