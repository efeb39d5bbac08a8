/* What the command says of a run, and what a map says of a body: increments in place of times that
   mean nothing, signs, axes of space. */
#define _GNU_SOURCE
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/plot/plot_frame.h"
#include "runtime/result/hdf5_tools.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_read.h"
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
  expect(w, "run stop.nml", 0, "ended early at increment 4 of 8: moved was above 4e-07 m\n");
}

/* The block's upper particles lie at 20 mm and reach 5 mm further; maps of what stamps touch are
   not magnified unless that is asked for. */
static void stamps_are_told(void **state) {
  workplace *w = *state;
  write_text(w, "stamp.nml",
             "&simulation  end_time = '0.01 ms'  /\n"
             "&lattice     name = 'c'  kind = 'square'  spacing = '10 mm'  thickness = '10 mm'  /\n"
             "&material    lattice = 'c'  model = 'elastic_central'  /\n"
             "&body        lattice = 'c'  shape = 'rectangle'  corner = 0, 0  size = '30 mm', "
             "'20 mm'  /\n"
             "&stamp       name = 'ball'  shape = 'disc'  centre = 0, '40 mm'  radius = '10 mm'  "
             "mass = '0.5 kg'  velocity = '3 m/s'  direction = 0, -1  /\n"
             "&stamp       name = 'anvil'  shape = 'disc'  centre = 0, '-15 mm'  radius = '10 mm'  "
             "velocity = 0  /\n"
             "&output      result = 'stamp.h5'  fields = 'displacement', 'velocity'  /\n");
  expect(w, "run stamp.nml", 0,
         "  stamp      ball: 0.5 kg at 3 m/s along (0, -1), 5 mm from `c`\n");
  assert_non_null(strstr(w->said, "  stamp      anvil: its motion is prescribed, 0 nm from `c`\n"));
  assert_non_null(strstr(w->said, " (translation mode rules)\n"));
  expect(w, "run stamp.nml --set 'stamp[1].mass=1 mg' --set output.result=light.h5", 0,
         " (contact rules)\n");
  expect(w, "plot stamp.h5 --map velocity -o stamp.svg", 0, "written");
  expect(w, "plot stamp.h5 --map velocity --factor 7 -o seven.svg", 0, "written");
}

/* Rows of 4, 3 and 4 sites: one has all neighbours. */
static void exact_edges_are_told(void **state) {
  workplace *w = *state;
  write_text(w, "edges.nml",
             "&simulation  end_time = '0.01 ms'  /\n"
             "&lattice     name = 'c'  kind = 'hexagonal'  spacing = '10 mm'  thickness = '10 mm'  "
             "edges = 'exact'  /\n"
             "&material    lattice = 'c'  model = 'splm_elastic'  E = '25 GPa'  nu = 0.2  /\n"
             "&body        lattice = 'c'  shape = 'rectangle'  corner = 0, 0  size = '30 mm', "
             "'17.33 mm'  /\n");
  expect(w, "info edges.nml", 0, "lattice    c: hexagonal, spacing 10 mm, 11 particles, ");
  assert_non_null(strstr(w->said, "  edges      exact: 10 particles lack neighbours and have "));
  assert_non_null(strstr(w->said, ": held in a uniform strain E = 25 GPa, nu = 0.2000\n"));
  assert_non_null(strstr(w->said, "; 0 particles whose bonds do not resolve all strains\n"));
  assert_null(strstr(w->said, "blue noise"));
  expect(w, "info edges.nml --set material.model=elastic_micropolar", 1,
         "`elastic_micropolar` is a law of bonds, and a bond does not know which others its ends "
         "lack");
}

/* Without its line `accept` the law of a prestressed bond is refused; with it check, info, a run
   and its result show what is accepted. */
static void what_laws_accept_is_told(void **state) {
  workplace *w = *state;
  write_text(w, "prestressed.plm",
             "model prestressed\n  law central bond\n  for plane_stress\n"
             "  parameter rho = 2323 [kg/m^3] in (0, inf)\n"
             "  parameter EA = 2 [MN] in (0, inf)\n  force N = EA*(stretch - 1e-6)\n"
             "  accept rest-force \"it is prestressed\"\nend model\n");
  write_text(
      w, "prestressed.nml",
      "&simulation  end_time = '0.01 ms'  /\n"
      "&lattice     name = 'c'  kind = 'hexagonal'  spacing = '10 mm'  thickness = '10 mm' /\n"
      "&material    lattice = 'c'  model = 'prestressed'  /\n"
      "&body        lattice = 'c'  shape = 'rectangle'  corner = 0, 0  size = '30 mm', "
      "'30 mm' /\n"
      "&output      result = 'p.h5'  /\n");
  expect(w, "check prestressed.plm", 0, "no errors, 0 warnings, 1 finding accepted");
  assert_non_null(strstr(w->said, "[rest-force]\n"));
  assert_non_null(strstr(w->said, "  because: it is prestressed\n"));
  expect(w, "info prestressed.plm", 0, "Accepted, rest-force: it is prestressed\n");
  expect(w, "info prestressed.plm --json", 0, "\"check\": \"rest-force\"");
  expect(w, "explain prestressed.plm", 0, "Accepted, rest-force: it is prestressed\n");
  expect(w, "check prestressed.plm --diagnostics=json", 0, "\"severity\": \"accepted\"");
  const char *told = "  accepted   rest-force of `prestressed`: it is prestressed\n";
  expect(w, "run prestressed.nml", 0, told);
  char error[1000];
  result_file *f = result_read(in_workplace(w, "p.h5"), error, sizeof error);
  if (!f) fail_msg("%s", error);
  char *begin = result_read_text(f, "/said/begin");
  assert_non_null(strstr(begin, told));
  free(begin);
  result_read_close(f);
  assert_int_equal(shell(w, "sed -i /accept/d prestressed.plm"), 0);
  expect(w, "run prestressed.nml --set output.result=q.h5", 1, "[rest-force]");
}

/* Frames are at increments 3, where the beam has moved 0.375 um, 6 and 8, the end. */
static void runs_say_whether_frames_came(void **state) {
  workplace *w = *state;
  write_text(w, "framed.nml", quiet);
  assert_int_equal(shell(w, "printf \"&frame monitor = 'moved' above = '0.3 um' /\n"
                            "&frame monitor = 'moved' above = '2 um' /\n"
                            "&frame monitor = 'moved' below = 0.5 of = 'peak' /\n"
                            "&frame at = 0.75 /\n\" >> framed.nml"),
                   0);
  expect(w, "run framed.nml --set output.frames=0", 0, "written    quiet.h5 (3 frames)");
  assert_non_null(strstr(w->said, "  frame at increment 3 of 8: moved was above 3e-07 m\n"
                                  "  no frame for moved above 2e-06 m: it never was\n"
                                  "  no frame for moved below 50 % of its peak: it never was\n"));
  assert_null(strstr(w->said, "0.75"));
  char error[1000];
  long count;
  result_file *f = result_read(in_workplace(w, "quiet.h5"), error, sizeof error);
  if (!f) fail_msg("%s", error);
  double *times = result_read_frame_times(f, &count);
  assert_int_equal(count, 3);
  for (int k = 0; k < 3; k++)
    assert_true(fabs(8 * times[k] - (const double[]){3, 6, 8}[k]) < 1e-12);
  free(times);
  result_read_close(f);
}

static void dynamic_runs_have_times(void **state) {
  workplace *w = *state;
  expect(w, "run beam.nml --set monitor.scale=1", 0, "load       largest -");
  assert_non_null(strstr(w->said, "time       1 ms in "));
  assert_non_null(strstr(w->said, " N at t = "));
  assert_null(strstr(w->said, "increment"));
}

/* The first look at the clock is after 16 of 99 steps. */
static void progress_is_what_is_done(void **state) {
  workplace *w = *state;
  expect(w, "run beam.nml --set \"simulation.end_time='0.03 ms'\"", 0, "in 99 steps");
  assert_non_null(strstr(w->said, " 16 %  t = 0.0048969 ms"));
}

/* --- what results tell of their runs ---------------------------------------------------------- */

static void expect_ending(workplace *w, const char *name, const char *ended, int status) {
  char error[1000];
  result_file *f = result_read(in_workplace(w, name), error, sizeof error);
  if (!f) fail_msg("%s", error);
  char *words = result_read_words(f, "ended");
  if (strncmp(words, ended, strlen(ended)) != 0 || !*ended) fail_msg("said: %s", words);
  assert_true(result_read_number(f, "status") == status);
  assert_true(result_read_number(f, "wall_seconds") > 0);
  assert_true(result_read_number(f, "threads") == 1);
  assert_true(isnan(result_read_number(f, "nothing")) && isnan(result_read_number(f, "ended")));
  free(words);
  result_read_close(f);
  char line[400];
  snprintf(line, sizeof line, "info %s", name);
  expect(w, line, 0, ended);
}

static void results_tell_how_the_run_ended(void **state) {
  workplace *w = *state;
  expect(w, "run beam.nml --threads 1", 0, "written");
  expect_ending(w, "beam.h5", "end of the run", 0);
  expect(w, "info beam.h5", 0, " -O3 ");
  expect(w, "run beam.nml --threads 1 --interpret", 0, "written");
  expect(w, "info beam.h5", 0, "Compiler of the law: none: the law was interpreted\n");
  assert_int_equal(
      shell(w, "(cat beam.nml; echo \"&stop monitor = 'load' above = 1000 /\") > s.nml"), 0);
  expect(w, "run s.nml --threads 1", 0, "ended early");
  expect_ending(w, "beam.h5", "stopped by &stop at t = 0.", 0);
  expect(w, "info beam.h5", 0, " ms: load was above 1000 N (status 0); ");
  expect(w, "run beam.nml --threads 1 --set \"drive.velocity=-1e5 m/s\" --set drive.rise=", 2,
         "error: ");
  expect_ending(w, "beam.h5", "failed at t = ", 2);
  write_long_deck(w);
  const pid_t run = start_long_run(w, "part.h5", NULL);
  kill(run, SIGINT);
  assert_int_equal(end_of(run), 128 + SIGINT);
  expect_ending(w, "part.h5", "interrupted at t = ", 128 + SIGINT);
}

static void expect_words(const workplace *w, const char *set_name, const char *words) {
  char found[300];
  h5_quiet();
  const hid_t file = H5Fopen(in_workplace(w, "beam.h5"), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t set = H5Dopen2(file, set_name, H5P_DEFAULT);
  assert_true(set >= 0 && h5_read_attribute_text(set, "long_name", found, sizeof found));
  assert_string_equal(found, words);
  H5Dclose(set);
  H5Fclose(file);
}

static void quantities_are_told_in_words(void **state) {
  static const char monitors[] =
      "&monitor  name = 'ends'  kind = 'reaction'  between = 'left', 'right'  component = 'y'  /\n"
      "&monitor  name = 'turn'  kind = 'displacement'  region = 'right'  component = 'rotation'  "
      "zero_at = '0.5 ms'  /\n"
      "&monitor  name = 'speed'  kind = 'velocity'  region = 'right'  component = 'x'  average = "
      "'0.1 ms'  /\n"
      "&monitor  name = 'span'  kind = 'opening'  between = 'left', 'right'  component = 'x'  /\n"
      "&monitor  name = 'hurt'  kind = 'damaged'  above = 0.25  /\n"
      "&monitor  name = 'gone'  kind = 'broken'  /\n";
  workplace *w = *state;
  char *deck = calloc(sizeof small_deck + sizeof monitors, 1);
  strcat(strcat(deck, small_deck), monitors);
  write_text(w, "beam.nml", deck);
  free(deck);
  expect(w, "run beam.nml", 0, "written");
  expect_words(w, "/history/load", "reaction along y of `loader`, times -1");
  expect_words(w, "/history/ends", "half the reaction along y of `right` less that of `left`");
  expect_words(w, "/history/turn",
               "mean displacement in rotation of `right`, less its value at 0.0005 s");
  expect_words(w, "/history/speed", "mean velocity along x of `right`, mean over 0.0001 s");
  expect_words(w, "/history/span", "mean displacement along x of `right` less that of `left`");
  expect_words(w, "/history/hurt", "bonds with more damage than 0.25");
  expect_words(w, "/history/gone", "bonds with a damage of at least 1");
  expect_words(w, "/history/energy/external", "work of loads and drives");
  expect_words(w, "/history/time", "time of the sample");
  expect_words(w, "/frames/damage", "mean damage of the bonds that the particle began with");
  expect_words(w, "/frames/concrete/omega",
               "Loss of stiffness that puts the force on the softening curve (eq 3.15). A bond "
               "with omega = 1 is gone in tension and in compression.");
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
  expect(w, "plot beam.h5 quiet.h5 --x time --x-unit s", 0, "written beam_load.png");
  expect(w, "plot beam.h5 quiet.h5 --x energy/external", 0, "written beam_load.png");
}

static const char block[] =
    "&simulation  title = 'block'  end_time = '1 us'  /\n"
    "&lattice     name = 'c'  kind = 'cubic'  spacing = '10 mm'  shells = 2  /\n"
    "&material    lattice = 'c'  model = 'splm_elastic'  /\n"
    "&body        lattice = 'c'  shape = 'box'  corner = 0, 0, 0  size = '20 mm', '30 mm', '50 mm' "
    " /\n"
    "&output      result = 'block.h5'  frames = 1  fields = 'displacement'  /\n";

/* Lengths along x, y and z in a picture without perspective: the squares sum up to 1 in either
   direction. */
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

/* Of its particles alone edges are drawn: those of the block around it, which have no stress of
   that name, are dots. */
static void bars_in_a_block_are_seen(void **state) {
  workplace *w = *state;
  size_t size;
  int edges = 0;
  write_text(w, "block.nml", block);
  assert_int_equal(shell(w, "echo \"&bar name = 'b' points = 0.01, 0.01, 0.01, 0.01, 0.01, 0.04 "
                            "spacing = 0.005 diameter = 0.002 / &material bar = 'b' "
                            "model = 'steel_bar' /\" >> block.nml"),
                   0);
  expect(w, "run block.nml --set \"output.fields='displacement', 'sigma'\"", 0, "written");
  expect(w, "plot block.h5 --map sigma -o bar.svg", 0, "written bar.svg");
  char *text = read_bytes(w, "bar.svg", &size);
  for (const char *at = text; (at = strstr(at, "stroke:rgb(25%")); at++)
    edges++;
  free(text);
  assert_int_equal(edges, 7);
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

/* --- blows, bodies over each other, damping --------------------------------------------------- */

/* All energy is brought by the block. */
static const char blow[] =
    "&simulation  end_time = '0.1 ms'  /\n"
    "&lattice     name = 'plate'  kind = 'hexagonal'  spacing = '5 mm'  thickness = '10 mm'  /\n"
    "&material    lattice = 'plate'  model = 'elastic_micropolar'  /\n"
    "&body        lattice = 'plate'  shape = 'rectangle'  corner = 0, 0  size = '50 mm', '40 mm'  "
    "/\n&lattice     name = 'block'  kind = 'hexagonal'  spacing = '5 mm'  thickness = '10 mm'\n"
    "             origin = '55.1 mm', 0  /\n"
    "&material    lattice = 'block'  model = 'elastic_micropolar'  /\n"
    "&body        lattice = 'block'  shape = 'rectangle'  corner = '55 mm', 0  size = '20 mm', "
    "'40 mm'  /\n"
    "&region      name = 'all'  lattice = 'block'  shape = 'rectangle'  corner = -1, -1  size = 3, "
    "3  /\n"
    "&initial_velocity  region = 'all'  component = 'x'  value = -10  /\n"
    "&output      result = 'blow.h5'  frames = 1  /\n";

static double number_behind(const char *text, const char *words) {
  const char *at = strstr(text, words);
  assert_non_null(at);
  return strtod(at + strlen(words), NULL);
}

static void blows_are_told(void **state) {
  workplace *w = *state;
  write_text(w, "blow.nml", blow);
  assert_int_equal(shell(w, "echo \"&contact name = 'blow' /\" >> blow.nml"), 0);
  expect(w, "run blow.nml", 0,
         "  contact    blow: at most 5 pairs of particles in touch at a time, ");
  assert_true(number_behind(w->said, "at a time, ") > 1); /* kN */
  const double imbalance = fabs(number_behind(w->said, "; imbalance ")),
               part = number_behind(strstr(w->said, "; imbalance "), " J (");
  assert_non_null(strstr(w->said, " % of the largest energy)"));
  /* 40 particles of 2323 kg/m^3 at 10 m/s */
  const double brought = 0.5 * 40 * 2323 * sqrt(0.75) * 0.005 * 0.005 * 0.01 * 100;
  assert_true(fabs(100 * imbalance / part / brought - 1) < 0.05); /* of two digits */
  expect(w, "run blow.nml --json", 0, "\"largest\": 1.00");
  expect(w, "run blow.nml --set initial_velocity.value=10", 0,
         "  contact    blow: nothing touched\n");
}

static void bodies_over_each_other_are_told(void **state) {
  workplace *w = *state;
  write_text(w, "blow.nml", blow);
  expect(w, "check blow.nml", 0, "");
  assert_null(strstr(w->said, "lie over each other"));
  assert_int_equal(shell(w, "sed -i \"s/'55 mm'/'45 mm'/\" blow.nml"), 0);
  expect(w, "check blow.nml", 0,
         "blow.nml:8:1: warning: bodies of `plate` and `block` lie over each other from the "
         "beginning: particles of theirs are nearer than half a spacing, 15 pairs in all");
  assert_non_null(strstr(w->said, "no force acts between them: move one"));
  assert_non_null(strstr(w->said, "blow.nml:4:1: note: the other body"));
  assert_int_equal(shell(w, "echo \"&contact name = 'blow' /\" >> blow.nml"), 0);
  expect(w, "run blow.nml", 0, "a `&contact` keeps them no further apart than they begin");
}

/* Eight increments, and what breaks in the first of them moves; a hundred; none breaks. */
static void much_damping_is_told(void **state) {
  workplace *w = *state;
  static const char warning[] = "warning: the relaxation damped ";
  write_text(w, "quiet.nml", quiet);
  expect(w, "run quiet.nml --set \"drive.displacement=-0.05 mm\"", 0, warning);
  assert_non_null(strstr(w->said, "`relaxation.increments=16` and compare"));
  expect(w, "run quiet.nml --set \"drive.displacement=-0.05 mm\" --set relaxation.increments=100",
         0, "");
  assert_null(strstr(w->said, warning));
  expect(w, "run quiet.nml --set relaxation.increments=1", 0, "");
  assert_true(number_behind(w->said, "by damping ") >
              0.1 * number_behind(w->said, "external work "));
  assert_null(strstr(w->said, warning));
}

int main(void) {
#define ONE(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
  const struct CMUnitTest tests[] = {
      ONE(quasi_static_runs_count_increments),
      ONE(stamps_are_told),
      ONE(exact_edges_are_told),
      ONE(what_laws_accept_is_told),
      ONE(runs_say_whether_frames_came),
      ONE(dynamic_runs_have_times),
      ONE(progress_is_what_is_done),
      ONE(results_tell_how_the_run_ended),
      ONE(quantities_are_told_in_words),
      ONE(maps_know_their_increment),
      ONE(maps_of_space_have_axes),
      ONE(bars_in_a_block_are_seen),
      ONE(what_sites_make_of_shapes),
      ONE(blows_are_told),
      ONE(bodies_over_each_other_are_told),
      ONE(much_damping_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
