/* Several frames in one picture, by number and by the values of a history, marks on particles and
   bonds, and two damages in one map. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdbool.h>

#include "tests/generator/command_tools.h"
#include "tests/runtime/small_result.h"

enum { FRAMES = 5, TIMES = 9 };

/* Frames at 0, 1, ... 4 s; cmod in mm at every half second: up to 2, back, and on; up to 12 between
   frames. */
static const double cmod[TIMES] = {0, 1, 2, 1, 0.5, 2, 4, 12, 8};

static void make_result(const workplace *w) {
  char error[512];
  double u[2 * PARTICLES], omega[BONDS], time[TIMES], opening[TIMES];
  const double *values[] = {u, omega};
  const result_header h = small_header(in_workplace(w, "a.h5"));
  result *r = small_begin(&h, error, sizeof error);
  assert_non_null(r);
  for (int k = 0; k < FRAMES; k++) {
    small_frame(k, u, omega);
    assert_true(result_frame(r, k, values, error, sizeof error));
  }
  for (int k = 0; k < TIMES; k++) {
    time[k] = 0.5 * k;
    opening[k] = 1e-3 * cmod[k];
  }
  const result_series series[] = {{.name = "cmod", .unit = "m", .values = opening}};
  const result_ending e = {.ended = "at the end",
                           .dt = 1e-3,
                           .steps = 42,
                           .time = time,
                           .history_count = TIMES,
                           .series = series,
                           .series_count = 1};
  assert_true(result_finish(r, &e, error, sizeof error));
  result_discard(r);
  result_close(r);
}

static bool same_pictures(const workplace *w, const char *a, const char *b) {
  size_t sizes[2];
  char *texts[2] = {read_bytes(w, a, &sizes[0]), read_bytes(w, b, &sizes[1])};
  const bool same = sizes[0] == sizes[1] && memcmp(texts[0], texts[1], sizes[0]) == 0;
  free(texts[0]);
  free(texts[1]);
  return same;
}

/* A single frame that is chosen in another way is the same picture. */
static void is_frame(workplace *w, const char *chosen, int frame) {
  assert_int_equal(shell(w, "$P plot a.h5 --map damage --frames %s --factor 1 -o b.svg", chosen),
                   0);
  assert_int_equal(shell(w, "$P plot a.h5 --map damage --frame %d --factor 1 -o a.svg", frame), 0);
  if (!same_pictures(w, "a.svg", "b.svg")) fail_msg("%s is not frame %d", chosen, frame);
}

static void frames_are_found_by_number_and_by_value(void **state) {
  workplace *w = *state;
  make_result(w);
  is_frame(w, "3", 3);
  is_frame(w, "-2", 3);
  is_frame(w, "cmod=0", 0);
  is_frame(w, "cmod=0.4mm", 0);  /* at 0.2 s: 0 mm at frame 0, 2 mm at frame 1 */
  is_frame(w, "cmod=1.9mm", 1);  /* at 0.95 s, not later on */
  is_frame(w, "'cmod=3 mm'", 3); /* at 2.75 s: 0.5 mm at frame 2, 4 mm at frame 3 */
  is_frame(w, "cmod=0.007", 4);  /* in SI */
  is_frame(w, "time=1.6", 2);
}

static void several_frames_in_one_picture(void **state) {
  workplace *w = *state;
  make_result(w);
  expect(w, "plot a.h5 --map damage --frames 'cmod=0mm,2mm,4 mm,8mm' -o b.svg", 0, "written b.svg");
  expect(w, "plot a.h5 --map damage --frames 0,1,3,4 -o a.svg", 0, "written a.svg");
  assert_false(same_pictures(w, "a.svg", "b.svg")); /* other captions */
  expect(w, "plot a.h5 --map displacement --frames 0,-1 --component 0 -o c.png", 0, "written");
  expect(w, "plot a.h5 --map omega --frames 0,1,2,3,4 -o c.pdf", 0, "written");
}

static void mistakes_are_said(void **state) {
  workplace *w = *state;
  make_result(w);
  static const struct {
    const char *line, *wanted;
    int status;
  } list[] = {
      {"plot a.h5 --map damage --frames cmod=13mm",
       "`cmod` never is 13 mm: it comes as near as 12 mm", 1},
      {"plot a.h5 --map damage --frames cmod=1mm,-3mm", "comes as near as 0 mm", 1},
      {"plot a.h5 --map damage --frames cmod=11mm -o a.png",
       "no frame is near `cmod` = 11 mm: the nearest, 4, has 8 mm and misses it by 3 mm", 0},
      {"plot a.h5 --map damage --frames 'cmod=2 kN'", "`cmod` is in m", 1},
      {"plot a.h5 --map damage --frames cmod=1mm,,2mm", "is no value of it", 1},
      {"plot a.h5 --map damage --frames cmd=1mm", "has no history `cmd`", 1},
      {"plot a.h5 --map damage --frames 1,x", "--frames needs numbers, e.g. 0,5,-1, or values", 1},
      {"plot a.h5 --map damage --frames ''", "--frames needs", 1},
      {"plot a.h5 --map damage --frames 1,5", "there is no frame 5", 1},
      {"plot a.h5 --map damage --frames 1 --frame 1", "give one of them", 1},
      {"plot a.h5 --frames 1", "--frames belongs to maps", 1},
      {"plot a.h5 --mark omega", "--mark belongs to maps", 1},
      {"plot a.h5 --map damage --mark omga", "has no field `omga`; did you mean `omega`?", 1},
      {"plot a.h5 --map damage --mark 'displacement > 1 kN'", "with a value in a unit of `m`", 1},
      {"plot a.h5 --map damage --mark 'omega >'", "in a unit of `1`, not ``", 1},
  };
  for (size_t k = 0; k < sizeof list / sizeof *list; k++)
    expect(w, list[k].line, list[k].status, list[k].wanted);
  assert_int_equal(shell(w, "$P plot a.h5 --map damage --frames $(seq -s, 0 60)"), 1);
  assert_non_null(strstr(w->said, "has 61 frames; one picture shows 48 at most"));
}

static int times_in(const char *text, const char *what) {
  int count = 0;
  for (const char *p = text; (p = strstr(p, what)); p++)
    count++;
  return count;
}

/* Of three particles in a row the middle one moves: one bond tears, the other is crushed. */
static const char torn_and_crushed[] =
    "&simulation end_time = '2 ms' /\n"
    "&lattice name = 'c' kind = 'hexagonal' spacing = '20 mm' thickness = '127 mm' /\n"
    "&material lattice = 'c' model = 'mplm_concrete' crushing = 'text' /\n"
    "&body lattice = 'c' shape = 'rectangle' corner = 0, -0.001 size = 0.04, 0.002 /\n"
    "&region name = 'ends' shape = 'polygon' points = -0.01, -0.01, 0.05, -0.01, 0.05, 0.01, 0.03, "
    "0.01, 0.03, -0.005, 0.01, -0.005, 0.01, 0.01, -0.01, 0.01 /\n"
    "&region name = 'middle' shape = 'point' at = 0.02, 0 /\n"
    "&support region = 'ends' fix = 'x', 'y', 'rotation' /\n"
    "&support region = 'middle' fix = 'y', 'rotation' /\n"
    "&drive region = 'middle' component = 'x' displacement = '0.022 mm' times = 0, '1 ms', '2 ms' "
    "values = 0, 1, 4 /\n"
    "&output result = 'two.h5' frames = 2 fields = 'displacement', 'damage', 'omega_t', 'omega_c' "
    "/\n";

/* Colours of the two bonds, and of the two lines of the legend. */
static void two_damages_have_two_colours_each(void **state) {
  workplace *w = *state;
  static const char *const inks[4] = {"rgb(95%,80%,10%)", "rgb(35%,70%,95%)", "rgb(0%,0%,0%)",
                                      "rgb(5%,20%,65%)"};
  write_text(w, "two.nml", torn_and_crushed);
  expect(w, "run two.nml", 0, "two.h5");
  for (int frame = 1; frame <= 2; frame++) {
    size_t size;
    shell(w, "$P plot two.h5 --map omega_t,omega_c --frame %d --factor 1 -o two.svg", frame);
    char *text = read_bytes(w, "two.svg", &size);
    for (int k = 0; k < 4; k++) {
      const int wanted = (k < 2) == (frame == 1) ? 2 : 0;
      if (times_in(text, inks[k]) != wanted)
        fail_msg("frame %d: %s stands %d times", frame, inks[k], times_in(text, inks[k]));
    }
    free(text);
  }
  expect(w, "plot two.h5 --map omega_t,displacement", 1, "`displacement` is not on bonds");
  expect(w, "plot two.h5 --map omega_t,omega_x", 1, "did you mean `omega_c`?");
}

/* A bar beside the sites, whose bonds and links are shorter than the lattice's, hides none. */
static void bars_hide_no_bonds(void **state) {
  workplace *w = *state;
  write_text(w, "bar.nml",
             "&simulation end_time = '1 us' /\n"
             "&lattice name = 'c' kind = 'hexagonal' spacing = '20 mm' thickness = '0.1 m' /\n"
             "&material lattice = 'c' model = 'mplm_concrete' /\n"
             "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.2, 0.1 /\n"
             "&bar name = 'b' points = 0.011, 0.02, 0.19, 0.02 diameter = 0.01 spacing = '5 mm' /\n"
             "&material bar = 'b' model = 'steel_bar' /\n"
             "&link name = 'l' bar = 'b' lattice = 'c' /\n"
             "&material link = 'l' model = 'bar_bond' /\n"
             "&output result = 'bar.h5' frames = 1 fields = 'displacement', 'omega_t', 'omega_c' "
             "/\n");
  expect(w, "run bar.nml", 0, "bar.h5");
  expect(w, "plot bar.h5 --map omega_t,omega_c -o bar.svg", 0, "written");
}

/* Marks of a picture, without that of the legend: by their colour. */
static int marks_in(workplace *w, const char *mark) {
  size_t size;
  int count = -1;
  assert_int_equal(
      shell(w, "$P plot a.h5 --map damage --frame 1 --factor 1 --mark '%s' -o m.svg", mark), 0);
  char *text = read_bytes(w, "m.svg", &size);
  for (const char *p = text; (p = strstr(p, "rgb(5%,25%,80%)")); p++)
    count++;
  free(text);
  return count;
}

/* In frame 1 bonds have 0.25 and 0.375, particles move by 1.421, 1.563 and 1.704 m. */
static void marks_stand_where_the_field_says(void **state) {
  workplace *w = *state;
  make_result(w);
  assert_int_equal(marks_in(w, "omega"), 2);
  assert_int_equal(marks_in(w, "omega > 0.3"), 1);
  assert_int_equal(marks_in(w, "concrete/omega<0.3"), 1);
  assert_int_equal(marks_in(w, "omega > 40 %"), 0);
  assert_int_equal(marks_in(w, "displacement"), 3);
  assert_int_equal(marks_in(w, "displacement > 1500 mm"), 2);
  assert_int_equal(marks_in(w, "displacement < 1.5"), 1);
}

/* Cells of three nodes beside cells of four: each has its colour, with or without its law's
   field. */
static void triangles_among_quadrilaterals(void **state) {
  workplace *w = *state;
  expect(w,
         "run " SOURCE_DIR
         "/examples/crack_band/turned.nml --threads 1 --set relaxation.increments=1 "
         "--set mesh.file=turned_20.msh --set output.result=turned.h5 --set output.frames=1",
         0, "12 triangles");
  expect(w, "plot turned.h5 --map D -o damage.svg", 0, "damage.svg");
  expect(w, "plot turned.h5 --map displacement -o moved.png", 0, "moved.png");
}

int main(void) {
  const struct CMUnitTest tests[] = {
#define IN_WORKPLACE(test)                                                                         \
  cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
      IN_WORKPLACE(frames_are_found_by_number_and_by_value),
      IN_WORKPLACE(several_frames_in_one_picture),
      IN_WORKPLACE(mistakes_are_said),
      IN_WORKPLACE(marks_stand_where_the_field_says),
      IN_WORKPLACE(two_damages_have_two_colours_each),
      IN_WORKPLACE(bars_hide_no_bonds),
      IN_WORKPLACE(triangles_among_quadrilaterals)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
