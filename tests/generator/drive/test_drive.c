/* perilat drive and perilat info: paths against closed forms
   of their own, refusals, and the file that a failing run leaves. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "generator/drive/drive_grammar.h"
#include "generator/drive/drive_motion.h"
#include "generator/drive/drive_path.h"
#include "generator/drive/drive_table.h"
#include "generator/kernel/model.h"
#include "runtime/deck/deck_groups.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_read.h"

enum { TEXT = 65536 };

/* Runs the program in the test's folder; its output, both channels, into `text`. Returns the exit
 * status. */
static int perilat(const char *arguments, char *text) {
  char command[2048];
  snprintf(command, sizeof command, "PERILAT_MODELS='%s/models' '%s' %s 2>&1", SOURCE_DIR,
           PERILAT_PROGRAM, arguments);
  FILE *in = popen(command, "r");
  assert_non_null(in);
  size_t n = fread(text, 1, TEXT - 1, in);
  text[n] = 0;
  int status = pclose(in);
  assert_true(WIFEXITED(status));
  return WEXITSTATUS(status);
}

static void write_file(const char *path, const char *text) {
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  fputs(text, out);
  assert_int_equal(fclose(out), 0);
}

static void expect(const char *arguments, int status, const char *part) {
  char text[TEXT];
  int got = perilat(arguments, text);
  if (got != status || !strstr(text, part))
    fail_msg("perilat %s\nstatus %d, not %d, or no `%s` in\n%s", arguments, got, status, part,
             text);
}

static void drive(const char *path_text, const char *options, int status, const char *part) {
  char arguments[256];
  write_file("drive_test.nml", path_text);
  snprintf(arguments, sizeof arguments, "drive drive_test.nml %s", options);
  expect(arguments, status, part);
}

static void near(double value, double expected, double allowed) {
  if (!(fabs(value - expected) <= allowed)) fail_msg("%.17g is not %.17g", value, expected);
}

/* --- expectations ----------------------------------------------------------------------------- */

#define ELASTIC "&material model = 'elastic_central' /\n&bond spacing = '10 mm' /\n"
#define FIBRES(given)                                                                              \
  "&particle lattice = 'hexagonal' spacing = '10 mm' thickness = '100 mm' /\n"                     \
  "&material model = 'pmb_fibre' " given " /\n"                                                    \
  "&path quantity = 'strain_xx' times = 0, '1 s' values = 0, 1e-4 /\n"
#define TO_MICRO "&path quantity = 'stretch' value = 1e-4 rise = '1 s' /\n"

/* EA = sqrt(3)/2 * 30 GPa * 10 mm * 100 mm = 25.98 MN, so 2598.08 N at 1e-4. */
static void a_failed_expectation_is_status_2(void **state) {
  (void)state;
  drive(ELASTIC TO_MICRO "&expect quantity = 'N' value = '2598.0762 N' /\n", "", 0,
        "1 of 1 expectations hold");
  drive(ELASTIC TO_MICRO "&expect quantity = 'N' value = '2.5980762 kN' /\n", "", 0, "PASS");
  drive(ELASTIC TO_MICRO "&expect quantity = 'N' value = '2600 N' /\n", "", 2,
        "FAIL  drive_test.nml:4: N = 2598.07621 N, expected 2600");
  drive(ELASTIC TO_MICRO "&expect quantity = 'N' value = '2600 N' absolute = '2 N' /\n", "", 0,
        "PASS");
  drive(ELASTIC TO_MICRO "&expect quantity = 'N' value = '2600 N' tolerance = 1e-3 /\n", "", 0,
        "PASS");
  /* in parts of what is expected, not of what was found */
  drive(ELASTIC TO_MICRO "&expect quantity = 'N' value = '1500 N' tolerance = 0.6 /\n", "", 2,
        "FAIL");
  drive(ELASTIC TO_MICRO "&expect quantity = 'N' formula = 'EA*2e-4' /\n", "", 2,
        "0 of 1 expectations hold");
  drive(ELASTIC TO_MICRO "&expect quantity = 'N' formula = 'EA*1e-4' /\n", "--set E='15 GPa'", 0,
        "N = 1299.03811 N");
  drive(ELASTIC TO_MICRO "&expect quantity = 'N' value = '2598.0762 N' /\n", "--set E='15 GPa'", 2,
        "FAIL");
  drive(ELASTIC TO_MICRO "&expect quantity = 'N' value = '2598.0762 N' /\n",
        "--set E='15 GPa' --set E='30 GPa'", 0, "PASS"); /* the last one counts */
  drive("&material model = 'elastic_central' E = '15 GPa' /\n&bond spacing = '10 mm' /\n" TO_MICRO
        "&expect quantity = 'N' value = '2598.0762 N' /\n",
        "--set e=", 0, "PASS");
}

static void the_first_of_equal_peaks_counts(void **state) {
  (void)state;
  drive(ELASTIC
        "&path quantity = 'stretch' times = 0, '1 s', '2 s', '3 s' values = 0, 1e-4, 1e-4, 0 /\n"
        "&expect quantity = 'time at peak N' value = '1 s' /\n",
        "", 0, "PASS");
}

/* A slider with hardening beside a spring: energy is locked in, and given back when it slips the
   other way. */
static void a_fall_of_the_dissipation_is_explained(void **state) {
  (void)state;
  static const char slider[] = "model slider\n  law central bond\n"
                               "  parameter rho = 1 [kg/m^3] in (0, inf)\n"
                               "  parameter k = 1 [MN] in (0, inf)\n"
                               "  parameter h = 3 in [0, inf)\n"
                               "  state p on bond = 0\n"
                               "  trial = stretch - (1 + h)*p\n"
                               "  p = | p + (trial - 1e-4)/(1 + h) when trial > 1e-4\n"
                               "      | p + (trial + 1e-4)/(1 + h) when trial < -1e-4\n"
                               "      | p otherwise\n";
  static const char path[] = "&bond spacing = '10 mm' /\n&path quantity = 'stretch' wave = "
                             "'triangle' value = 5e-4 period = '1 s' /\n";
  char text[4096], said[TEXT];
  write_file("drive_path.nml", path);
  snprintf(text, sizeof text, "%s  force N = k*(stretch - p)\nend model\n", slider);
  write_file("slider.plm", text);
  expect("drive slider.plm drive_path.nml", 0, "note: `dissipated_damage` falls, by most up to");
  expect("drive slider.plm drive_path.nml", 0, "without `energy W`");
  snprintf(text, sizeof text, "%s  energy W = k*s/2*((stretch - p)**2 + h*p**2)\nend model\n",
           slider);
  write_file("slider.plm", text);
  assert_int_equal(perilat("drive slider.plm drive_path.nml", said), 0);
  assert_null(strstr(said, "note:"));
}

static void closed_forms_see_the_row(void **state) {
  (void)state;
  drive(ELASTIC TO_MICRO
        "&expect quantity = 'stored' at_time = '0.25 s' formula = 'EA*s*stretch**2/2' tolerance = "
        "1e-13 /\n"
        "&expect quantity = 'N' at_stretch = 3.3e-5 formula = 'EA*3.3e-5' tolerance = 1e-12 /\n"
        "&expect quantity = 'lowest N' value = 0 /\n"
        "&expect quantity = 'time at peak N' value = '1 s' /\n",
        "", 0, "4 of 4");
}

/* The strength 1e-4 lies between two of the rows 0, 1.5e-4, 3e-4, ... */
#define COHESIVE                                                                                   \
  "&simulation steps = 4 /\n&material model = 'cohesive' f_t = '3 MPa' E = '30 GPa' /\n"           \
  "&path quantity = 'stretch' value = 6e-4 rise = '1 s' /\n"                                       \
  "&expect quantity = 'peak N' formula = 'EA*S_t' tolerance = 1e-3 /\n"

static void a_missed_peak_says_where_it_may_lie(void **state) {
  (void)state;
  drive(COHESIVE, "", 2, "the rows beside it are at 0 s and 0.5 s");
  drive(COHESIVE, "", 2, "--set simulation.steps=40");
  drive(COHESIVE, "--set simulation.steps=6", 0, "1 of 1");
  drive(COHESIVE, "--set simulation.stps=6", 1, "did you mean `steps`?");
  drive(ELASTIC TO_MICRO, "--set bond.spacing='5 mm'", 0, "s = 5 mm");
  drive(ELASTIC TO_MICRO, "--set initial.omega=0.5", 1, "has no state or damage `omega`");
}

/* Row by row: ends, corners and the largest force are printed whatever `rows` leaves room for. */
static void the_printed_rows_have_the_corners(void **state) {
  (void)state;
  static const char zigzag[] =
      ELASTIC "&output rows = 6 /\n&path quantity = 'stretch' times = 0, 0.3, 0.77, 1 values = 0, "
              "1e-4, -3e-4, 0 /\n";
  static const char *const times[] = {"\n         0 ", "\n       0.3 ", "\n      0.77 ",
                                      "\n         1 "};
  char text[TEXT];
  for (size_t k = 0; k < sizeof times / sizeof *times; k++)
    drive(zigzag, "", 0, times[k]);
  assert_int_equal(perilat("drive drive_test.nml", text), 0);
  int lines = 0;
  for (const char *c = text; *c; c++)
    lines += *c == '\n';
  assert_int_equal(lines, 2 + 6);
}

/* Each block of columns begins with the time, and as many rows follow in each. */
static void wide_tables_go_on_below(void **state) {
  (void)state;
  enum { PAGE = 132 };
  static char said[TEXT];
  char arguments[600];
  int blocks = 0, rows = 0, widest = 0;
  snprintf(arguments, sizeof arguments,
           "drive %s/models/drives/splm_concrete_compression.nml --set output.rows=5", SOURCE_DIR);
  assert_int_equal(perilat(arguments, said), 0);
  assert_null(strstr(said, "not shown"));
  for (char *line = strtok(said, "\n"); line; line = strtok(NULL, "\n")) {
    if (strncmp(line, "PASS", 4) == 0 || strstr(line, "expectations")) continue;
    const bool heading = strncmp(line, "  time [s]", 10) == 0;
    if (blocks > 0 || heading) {
      widest = (int)strlen(line) > widest ? (int)strlen(line) : widest;
      assert_int_equal(strspn(line, " ") < 10 && line[9] != ' ', 1);
      rows += !heading;
    }
    blocks += heading;
  }
  assert_true(blocks > 1 && rows == 5 * blocks);
  assert_true(widest <= PAGE && widest > PAGE / 2);
}

static void single_neighbours_of_many_are_left_out(void **state) {
  (void)state;
  static char said[TEXT];
  char arguments[600];
  snprintf(arguments, sizeof arguments, "drive %s/models/drives/eps.nml", SOURCE_DIR);
  assert_int_equal(perilat(arguments, said), 0);
  assert_non_null(strstr(said, "244 columns of single neighbours are not shown")); /* 2 of 122 */
  assert_null(strstr(said, "F_1 "));
  assert_non_null(strstr(said, "mises [Pa]"));
}

/* --- refusals --------------------------------------------------------------------------------- */

static void bad_paths_are_explained(void **state) {
  (void)state;
  static const struct {
    const char *text, *part;
  } bad[] = {
      {"", "no `&path`"},
      {ELASTIC, "no `&path`: nothing happens"},
      {TO_MICRO, "no law is named"},
      {"&pth /", "a path has no group `&pth`"},
      {ELASTIC "&path quantity = 'strech' value = 1 /", "did you mean `stretch`?"},
      {ELASTIC "&path quantity = 'stretch' valu = 1 /", "did you mean `value`?"},
      {ELASTIC "&path quantity = 'stretch' value = '1 mm' /",
       "`value` is a pure number; `1 mm` is a length"},
      {ELASTIC "&path quantity = 'stretch' /", "`&path` needs `value`"},
      {ELASTIC "&path quantity = 'stretch' value = 1 period = '1 s' rise = 2 /",
       "does not go with a path of cycles"},
      {ELASTIC "&path quantity = 'stretch' period = '1 s' /", "needs `value`, their amplitude"},
      {ELASTIC "&path quantity = 'stretch' value = 1 period = '1 s' cycles = 1.5 /",
       "whole number from 1"},
      {ELASTIC "&path quantity = 'stretch' value = 1 period = 0 /",
       "`period` must be greater than 0"},
      {ELASTIC "&path quantity = 'stretch' times = 0, 1 values = 0 /", "must be equally many"},
      {ELASTIC "&path quantity = 'stretch' times = 1, 0 values = 0, 1 /",
       "later than the one before"},
      {ELASTIC "&path quantity = 'stretch' file = 'missing.csv' /", "cannot read `missing.csv`"},
      {ELASTIC "&path quantity = 'stretch' file = 'drive_test.nml' /",
       "`drive_test.nml` is not a table"},
      {ELASTIC "&path quantity = 'stretch' value = -1.5 rise = 1 /", "the bond has no length left"},
      {ELASTIC "&bond spacing = '5 mm' /\n" TO_MICRO, "a path has one `&bond`"},
      {ELASTIC "&simulation steps = 0 /\n" TO_MICRO, "`steps` must be at least 1"},
      {ELASTIC "&initial omega = 0.5 /\n" TO_MICRO, "has no state or damage `omega`"},
      {ELASTIC TO_MICRO "&expect quantity = 'N' /", "needs `value` or `formula`"},
      {ELASTIC TO_MICRO "&expect quantity = 'N' value = 1 formula = '1' /", "not both"},
      {ELASTIC TO_MICRO "&expect quantity = 'Nn' value = 1 /", "no column `Nn`"},
      {ELASTIC TO_MICRO "&expect quantity = 'peak of N' value = 1 /",
       "is not a quantity of the table"},
      {ELASTIC TO_MICRO "&expect quantity = 'peak N' at_time = 0 value = 1 /", "says itself when"},
      {ELASTIC TO_MICRO "&expect quantity = 'N' at_time = 2 value = 1 /", "the path ends at 1 s"},
      {ELASTIC TO_MICRO "&expect quantity = 'N' at_stretch = 1 value = 1 /",
       "the stretch never is 1"},
      {ELASTIC TO_MICRO "&expect quantity = 'N' at_stretch = 0 at_time = 0 value = 1 /",
       "exclude each other"},
      {ELASTIC TO_MICRO "&expect quantity = 'N' value = '1 mm' /", "`1 mm` is a length"},
      {ELASTIC TO_MICRO "&expect quantity = 'N' formula = 'EA*E' /",
       "`N` is a force (N), but this is"},
      {ELASTIC TO_MICRO "&expect quantity = 'N' formula = 'EAA*1e-4' /", "did you mean `EA`?"},
      {ELASTIC TO_MICRO "&expect quantity = 'N' formula = 'EA*(1e-4' /", "drive_test.nml:4:"},
      {ELASTIC TO_MICRO "&expect quantity = 'N' formula = 'EA)\nend model' /", "DECK"},
      {"&material model = 'elastic_central' EE = 1 /\n" TO_MICRO, "has no parameter `EE`"},
      {"&material model = 'elastic_central' E = -1 /\n" TO_MICRO, "is not in (0, inf)"},
      {FIBRES("fibre = 1"), "`fibre` is a vector, but one number is given"},
      {FIBRES("fibre = 1, 0, '1 mm'"), "`fibre_z` needs a pure number, this is a length (m)"},
      {FIBRES("fibres = 1, 0"), "did you mean `fibre`?"},
      {FIBRES("E_1 = 1, 5"), "`E_1` takes 1 value, but 2 are given"},
      {FIBRES("fibre = 1, 0  fibre_x = 2"), "`fibre_x` is given twice"},
      {FIBRES("fibre = 1, 2, 3, 4"), "`fibre` takes 1 value, of a vector 2 or 3, but 4 are given"},
      {FIBRES("fibre = 1, 'x', 0"), "`fibre_y` needs a number, not the word 'x'"},
      {"&material model = 'no_such_law' /\n" TO_MICRO, "there is no model `no_such_law`"},
      {"&material model = 'cohesive' /\n&bond setting = 'plane_strain' /\n" TO_MICRO,
       "the law `cohesive` is not meant for plane_strain"},
      {"&material model = 'cohesive' softening = 'liner' /\n" TO_MICRO, "has no choice `liner`"},
      {"&material model = 'mplm_bilinear' /\n&initial omega = 2 /\n" TO_MICRO,
       "is between 0 and 1"},
      {"&material model = 'mplm_bilinear' /\n&initial omega = '1 mm' /\n" TO_MICRO,
       "`omega` is a pure number"},
  };
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    char text[TEXT];
    write_file("drive_test.nml", bad[k].text);
    int status = perilat("drive drive_test.nml", text);
    bool refused = strcmp(bad[k].part, "DECK") == 0 ? strstr(text, "error:") != NULL
                                                    : strstr(text, bad[k].part) != NULL;
    if (status != 1 || !refused || strstr(text, " rows to ")) /* nothing has been driven */
      fail_msg("%s\nstatus %d, no `%s` in\n%s", bad[k].text, status, bad[k].part, text);
  }
  expect("drive", 1, "needs a path");
  expect("drive elastic_central", 1, "needs a path");
  expect("drive drive_test.nml --compild", 1, "did you mean `--compiled`?");
  expect("drive drive_test.nml drive_test.nml", 1, "is a second one");
  drive(ELASTIC TO_MICRO, "--set E", 1, "takes a name and its value");
  drive(ELASTIC TO_MICRO, "--set E=", 1, "no `E` is given to take back");
  drive(ELASTIC TO_MICRO, "--csv drive_test.nml", 1, "would overwrite `drive_test.nml`");
  drive(ELASTIC TO_MICRO, "--csv no_such_folder/a.csv", 2, "cannot write `no_such_folder/a.csv`");
}

/* --- paths ------------------------------------------------------------------------------------ */

typedef struct path {
  arena *memory;
  source_set sources;
  diagnostics said;
  drive_input *in;
} path;

static void open_path(path *p, const char *text) {
  *p = (path){.memory = arena_new()};
  diag_begin(&p->said, &p->sources);
  int file = source_add(&p->sources, "path.nml", text, strlen(text));
  p->in = drive_read(p->memory, &p->sources, file, NULL, 0, &p->said);
  if (!p->in) diag_print(&p->said, stderr);
  assert_non_null(p->in);
}

static void close_path(path *p) {
  diag_clear(&p->said);
  source_clear(&p->sources);
  arena_free(p->memory);
}

static void pieces_add_up(void **state) {
  (void)state;
  path p;
  open_path(&p, "&path quantity = 'stretch' value = 3 rise = '2 s' /\n"
                "&path quantity = 'stretch' value = 1 period = '4 s' cycles = 2 start = '2 s' wave "
                "= 'sine' /\n"
                "&path quantity = 'theta_i' value = 2 period = '4 s' /\n"
                "&path quantity = 'theta_j' value = 2 period = '4 s' wave = 'pulse' /\n");
  const double t = 2.7;
  near(drive_at(p.in, DRIVE_STRETCH, 1), 1.5, 1e-15);
  near(drive_at(p.in, DRIVE_STRETCH, t), 3 + sin(2 * M_PI * (t - 2) / 4), 1e-14);
  near(drive_slope(p.in, DRIVE_STRETCH, t), 2 * M_PI / 4 * cos(2 * M_PI * (t - 2) / 4), 1e-14);
  near(drive_at(p.in, DRIVE_THETA_I, 0.5), 1, 1e-15);
  near(drive_at(p.in, DRIVE_THETA_I, 2.5), -1, 1e-15);
  near(drive_slope(p.in, DRIVE_THETA_I, 2.5), -2, 1e-15);
  near(drive_at(p.in, DRIVE_THETA_J, 3), 1, 1e-15);
  near(drive_slope(p.in, DRIVE_THETA_J, 3), -1, 1e-15);
  near(drive_end(p.in), 10, 1e-15);
  close_path(&p);
}

static void times_meet_corners(void **state) {
  (void)state;
  path p;
  long count;
  open_path(&p, "&simulation steps = 4 /\n&path quantity = 'stretch' times = 0, 0.3, 1 values = 0, "
                "1e-3, 0 /\n"
                "&expect quantity = 'N' at_stretch = 5e-4 after = 0.5 value = 0 /\n");
  double *t = drive_times(p.in, &count);
  const double wanted[] = {0, 0.25, 0.3, 0.5, 0.65, 0.75, 1};
  assert_int_equal(count, 7);
  for (int k = 0; k < 7; k++)
    near(t[k], wanted[k], 1e-12);
  free(t);
  close_path(&p);
}

/* Without `value` the table holds the stretch itself, else factors. */
static void a_table_comes_from_a_file(void **state) {
  (void)state;
  static const char *const tables[] = {"time [s], stretch\n0, 0\n0.5, 1e-4\n2, 5e-5\n",
                                       "0; 0\n0.5; 1e-4\n2; 5e-5\n",
                                       "time [ms] stretch [%]\n0 0\n500 1e-2\n2000 5e-3\n"};
  for (int k = 0; k < 3; k++) {
    write_file("drive_table.csv", tables[k]);
    drive(ELASTIC "&path quantity = 'stretch' file = 'drive_table.csv' value = 2 /\n"
                  "&expect quantity = 'N' at_time = 0.5 formula = 'EA*2e-4' /\n&expect quantity = "
                  "'N' formula = 'EA*1e-4' /\n",
          "", 0, "2 of 2");
    drive(ELASTIC "&path quantity = 'stretch' file = 'drive_table.csv' /\n"
                  "&expect quantity = 'N' at_time = 0.5 formula = 'EA*1e-4' /\n",
          "", 0, "1 of 1");
  }
}

/* A rate of 10 1/s = rate_0 gives half of zeta, whatever the path does. */
static void a_rate_may_be_given(void **state) {
  (void)state;
  drive("&material model = 'mplm_bilinear' /\n" TO_MICRO
        "&path quantity = 'stretch_rate' value = '10 1/s' /\n"
        "&expect quantity = 'N' formula = '(1 + zeta/2)*EA*1e-4' tolerance = 1e-12 /\n",
        "", 0, "1 of 1");
}

static void damage_may_be_there_at_the_start(void **state) {
  (void)state;
  drive("&material model = 'mplm_bilinear' zeta = 0 /\n&initial omega = 0.25 /\n" TO_MICRO
        "&expect quantity = 'N' formula = '0.75*EA*1e-4' tolerance = 1e-12 /\n",
        "", 0, "1 of 1");
}

/* --- files ------------------------------------------------------------------------------------ */

static void results_can_be_read(void **state) {
  (void)state;
  char error[512], unit_text[32], text[TEXT];
  long count;
  drive(ELASTIC "&output csv = 'drive.csv' hdf5 = 'drive.h5' picture = 'drive.svg' /\n" TO_MICRO,
        "", 0, "written drive.svg");
  result_file *f = result_read("drive.h5", error, sizeof error);
  assert_non_null(f);
  double *N = result_read_series(f, "N", &count, unit_text, sizeof unit_text, error, sizeof error);
  assert_non_null(N);
  assert_int_equal(count, 1001);
  assert_string_equal(unit_text, "N");
  near(N[1000], sqrt(3) / 2 * 30e9 * 0.01 * 0.1 * 1e-4, 1e-9);
  free(N);
  result_read_close(f);
  assert_int_equal(perilat("plot drive.h5 --x stretch --y N -o drive.png", text), 0);
}

/* A law that cannot answer is named with its line; a run that meets such a state leaves the bond as
 * a path. */
static const char breaking_law[] =
    "model breaking\n  law central bond\n"
    "  parameter E = 30 [GPa] in (0, inf) \"modulus\"\n"
    "  parameter rho = 2000 [kg/m^3] in (0, inf) \"density\"\n"
    "  parameter S = 1e-4 in (0, 1) \"stretch beyond which there is no root\"\n"
    "  rest = sqrt(S - stretch)/sqrt(S)\n"
    "  force N = E*s*t*stretch*rest\n"
    "end model\n";

static void what_is_no_number_is_named(void **state) {
  (void)state;
  write_file("breaking.plm", breaking_law);
  drive(
      "&material model = 'breaking.plm' /\n&path quantity = 'stretch' value = 2.1e-4 rise = 1 /\n",
      "", 2, "breaking.plm:6: the law's `rest`");
}

/* Bonds along rows, and bonds between two rows, both of which then stay behind. */
static void a_failing_run_leaves_its_bond(void **state) {
  (void)state;
  static const char *const pulled[] = {
      "&region name = 'one' shape = 'rectangle' corner = '-1 mm', '-1 mm' size = '4 mm', '22 mm' "
      "/\n"
      "&region name = 'other' shape = 'rectangle' corner = '17 mm', '-1 mm' size = '6 mm', '22 mm' "
      "/\n"
      "&drive region = 'other' component = 'x' velocity = '200 mm/s' /\n",
      "&region name = 'one' shape = 'rectangle' corner = '-1 mm', '-1 mm' size = '22 mm', '4 mm' "
      "/\n"
      "&region name = 'other' shape = 'rectangle' corner = '-1 mm', '15 mm' size = '22 mm', '6 mm' "
      "/\n"
      "&drive region = 'other' component = 'y' velocity = '200 mm/s' /\n"};
  write_file("breaking.plm", breaking_law);
  for (size_t k = 0; k < sizeof pulled / sizeof *pulled; k++) {
    char text[2048];
    snprintf(text, sizeof text,
             "&simulation end_time = '0.2 ms' /\n"
             "&lattice name = 'c' kind = 'hexagonal' spacing = '5 mm' thickness = '100 mm' /\n"
             "&material lattice = 'c' model = 'breaking.plm' E = '20 GPa' /\n"
             "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = '20 mm', '20 mm' /\n%s"
             "&support region = 'one' fix = 'xy' /\n"
             "&output result = 'breaking_run.h5' frames = 2 /\n",
             pulled[k]);
    write_file("breaking_run.nml", text);
    unlink("breaking_run_bad_bond.nml");
    expect("run breaking_run.nml", 2, "perilat drive breaking_run_bad_bond.nml");
    expect("drive breaking_run_bad_bond.nml", 2, "breaking.plm:6: the law's `rest`");
  }
}

/* The README's tables are what the program says of itself. */
static void the_reference_is_true(void **state) {
  (void)state;
  char *text = NULL, error[256];
  size_t length = 0;
  FILE *out = open_memstream(&text, &length);
  assert_non_null(out);
  deck_reference(&drive_grammar, out);
  fclose(out);
  char *page =
      read_text_file(SOURCE_DIR "/models/drives/README.md", 1 << 20, &length, error, sizeof error);
  assert_non_null(page);
  if (!strstr(page, text)) fail_msg("models/drives/README.md should hold\n%s", text);
  free(page);
  free(text);
}

/* --- particles -------------------------------------------------------------------------------- */

static void a_particle_is_driven_by_strains(void **state) {
  (void)state;
#define PARTICLE  "&material model = 'splm_elastic' /\n&particle spacing = '5 mm' /\n"
#define STRETCHED "&path quantity = 'strain_xx' value = 1e-6 rise = '1 s' /\n"
  /* sides held: E/(1 - nu^2), and nu times that across; half of that times the strain on sqrt(3)/2
     s^2 t is stored */
  drive(PARTICLE STRETCHED
        "&expect quantity = 'stress_xx' formula = 'E*1e-6/(1 - nu**2)' tolerance = 1e-5 /\n"
        "&expect quantity = 'stress_yy' formula = 'nu*E*1e-6/(1 - nu**2)' tolerance = 1e-5 /\n"
        "&expect quantity = 'external' formula = 'V*E*1e-12/(1 - nu**2)/2' tolerance = 1e-5 /\n"
        "&expect quantity = 'final dissipated' value = 0 absolute = '1e-14 J' /\n",
        "", 0, "4 of 4");
  drive(PARTICLE "&path quantity = 'strain_xy' value = 1e-6 rise = '1 s' /\n"
                 "&expect quantity = 'stress_xy' formula = 'E/(1 + nu)*1e-6' tolerance = 1e-5 /\n",
        "--compiled", 0, "1 of 1");
  drive(PARTICLE TO_MICRO, "", 1, "a law of families is not driven by this quantity");
  drive(ELASTIC STRETCHED, "", 1, "a law of bonds is not driven by this quantity");
  /* what is missed is told by what is driven, and more steps are named where they may help */
  const char sheared[] = PARTICLE
      "&path quantity = 'strain_xy' value = 1e-6 rise = '1 s' /\n"
      "&expect quantity = 'peak stress_xy' formula = '%s*E/(1 + nu)*1 [1]' tolerance = 1e-3 /\n";
  char text[600];
  snprintf(text, sizeof text, sheared, "3e-6");
  drive(text, "", 2, "(at 1 s, strain_xy 1e-06)\n0 of 1");
  snprintf(text, sizeof text, sheared, "1.1e-6");
  drive(text, "", 2, "(at 1 s, strain_xy 1e-06)\n      the rows beside it are at");
  drive(PARTICLE "&path quantity = 'strain_zz' value = 1e-6 rise = '1 s' /\n", "", 1,
        "a law of families in the plane knows no such strain");
  drive("&material model = 'splm_elastic' /\n&particle lattice = 'kagome' /\n" STRETCHED, "", 1,
        "lattice");
#undef PARTICLE
}

/* The law is taken in the first of its settings that suits the lattice. */
static void the_lattice_says_where_a_particle_is(void **state) {
  (void)state;
#define OF(law, lattice)                                                                           \
  "&material model = '" law "' /\n&particle lattice = '" lattice "' shells = 2 /\n"
#define PULLED "&path quantity = 'strain_zz' value = 1e-6 rise = '1 s' /\n"
#define HELD                                                                                       \
  "&expect quantity = 'stress_zz' formula = 'E*(1 - nu)/((1 + nu)*(1 - 2*nu))*1e-6' "              \
  "tolerance = 1e-5 /\n"
  drive(OF("splm_elastic", "fcc") PULLED HELD, "", 0, "1 of 1");
  drive(OF("splm_concrete", "fcc") PULLED HELD, "--compiled", 0, "1 of 1");
  drive(OF("splm_elastic", "square") PULLED, "", 1, "a law of families in the plane knows no");
  static const char of_space[] = "model ball\n  law state\n  for space, plane_strain\n"
                                 "  parameter k = 1 [MN] in (0, inf)\n"
                                 "  parameter rho = 1000 [kg/m^3] in (0, inf)\n"
                                 "  force state F[j] = k*stretch[j]\n"
                                 "  energy W = sum(s*F[j]*stretch[j])/4\nend model\n",
                    of_plane[] = "model flat\n  law state\n  for plane_stress\n"
                                 "  parameter k = 1 [MN] in (0, inf)\n"
                                 "  parameter rho = 1000 [kg/m^3] in (0, inf)\n"
                                 "  force state F[j] = k*stretch[j]\n"
                                 "  energy W = sum(s*F[j]*stretch[j])/4\nend model\n";
  write_file("ball.plm", of_space);
  write_file("flat.plm", of_plane);
  /* six bonds of a hexagon: sigma = sum s n n n n k strain/(2 V), the sum of n^4 is 9/4 */
  drive("&material model = 'ball.plm' /\n&particle lattice = 'hexagonal' /\n" STRETCHED
        "&expect quantity = 'stress_xx' formula = '2.25*k*1e-6/(sqrt(3)*spacing*t)' tolerance = "
        "1e-5 /\n",
        "", 0, "1 of 1");
  drive(OF("flat.plm", "fcc") STRETCHED, "", 1, "this lattice does not suit the setting");
#undef OF
#undef PULLED
#undef HELD
#undef STRETCHED
}

/* --- info ------------------------------------------------------------------------------------- */

static void info_says_what_a_law_implies(void **state) {
  (void)state;
  const char *const lines[] = {
      "E = 30 GPa along x, 30 GPa along y; nu = 0.2, 0.2; G = 12.5 GPa",
      "largest force 2472.36 N at a stretch of 0.000118",
      "81.5872 N/m of a crack across it",                 /* 36.91 EA S_t^2 s/((sqrt(3)/2) s t) */
      "longitudinal 3667.76 m/s, transverse 2319.69 m/s", /* sqrt(E/(rho (1 - nu^2))), sqrt(G/rho)
                                                           */
      "rotation mode rules, 1.6337e+06 rad/s",            /* sqrt(20 (1 - 3 nu)/(1 - nu^2)) c/s */
  };
  for (size_t k = 0; k < sizeof lines / sizeof *lines; k++)
    expect("info mplm_bilinear --spacing '6.35 mm' --thickness '152.4 mm'", 0, lines[k]);
  expect("info mplm_bilinear --spacing=12.7e-3 --set S_t=8.0e-5", 0,
         "75.0011 N/m of a crack across it");
  expect("info mplm_bilinear --spacing='3.175 mm' --set S_t=1.5e-4", 0,
         "65.919 N/m of a crack across it");
  expect("info elastic_central --json", 0, "\"separates\": false");
  expect("info cohesive --set softening=exponential --json", 0, "\"chosen\": \"exponential\"");
  expect("info elastic_central", 0, "none: a bond never separates");
}

static void info_refuses(void **state) {
  (void)state;
  expect("info mplm_bilinear --spacing 5kg", 1, "`spacing` is a length; `5kg` is a mass");
  expect("info mplm_bilinear --spacing -5", 1, "must be greater than 0");
  expect("info mplm_bilinear --set nu=0.4", 1, "is not in [0, 0.33333333]");
  expect("info mplm_bilinear --set mu=0.4", 1, "did you mean `nu`?");
  expect("info mplm_bilinear --lattice cubic", 1, "is meant for plane_stress");
  expect("info mplm_bilinear --spacin 5", 1, "did you mean `--spacing`?");
  expect("info no_such_law --set E=1", 1, "there is no model `no_such_law`");
}

/* --- laws of others --------------------------------------------------------------------------- */

#define ANSWER "model answer\n  law central bond\n  parameter rho = 2323 [kg/m^3]\n"
#define PULLED "&path quantity = 'stretch' value = 1e-4 rise = 1 /\n"

/* Driven nevertheless, but the verdict of `perilat check` is told; a good law is passed over. */
static void a_rejected_law_is_named(void **state) {
  (void)state;
  char text[TEXT];
  write_file("rejected.plm", ANSWER "  force N = (-3 [kN])*stretch\nend model\n");
  drive("&material model = 'rejected' /\n" PULLED, "", 0,
        "note: `perilat check ./rejected.plm` rejects this law [stiffness]");
  expect("check rejected.plm", 1, "[stiffness]");
  write_file("accepted.plm", ANSWER "  force N = 3 [kN]*stretch\nend model\n");
  write_file("drive_test.nml", "&material model = 'accepted' /\n" PULLED);
  assert_int_equal(perilat("drive drive_test.nml", text), 0);
  assert_null(strstr(text, "rejects"));
}

static void a_formula_with_holes_is_named(void **state) {
  (void)state;
  write_file("accepted.plm", ANSWER "  force N = 3 [kN]*stretch\nend model\n");
  drive("&material model = 'accepted' /\n" PULLED "&expect quantity = 'N' formula = '?' /\n", "", 1,
        "drive_test.nml:3:35: error: this formula is still to be written [hole]");
}

static void a_law_with_holes_is_not_driven(void **state) {
  (void)state;
  write_file("holes.plm", ANSWER "  constant EA = ?\n  force N = EA*stretch\nend model\n");
  drive("&material model = 'holes' /\n" PULLED, "", 1,
        "holes.plm:4:17: error: the constant `EA` is still to be written: a force (N) [hole]");
}

/* In a folder of its own, beside which are a secret and a place to write to. */
static void confined_drives_keep_to_their_folder(void **state) {
  (void)state;
  (void)system("rm -rf confined_drive; mkdir -p confined_drive/own; "
               "ln -s ../shared.plm confined_drive/own/link.plm");
  write_file("confined_drive/shared.plm", "function twice(x) = 2*x\n");
  write_file("confined_drive/own/own.plm", "function once(x) = 1*x\n");
  write_file("confined_drive/own/path.nml", "&material model = 'answer' /\n" PULLED);
  static const struct {
    const char *include, *options, *part;
    int free, confined;
  } cases[] = {{"own.plm", "", "1 s", 0, 0},
               {"../shared.plm", "", "`../shared.plm` cannot be read", 0, 1},
               {"link.plm", "", "`link.plm` cannot be read", 0, 1},
               {"own.plm", "--csv confined_drive/own/out.csv", "written", 0, 0},
               {"own.plm", "--csv confined_drive/out.csv", "cannot write", 0, 2},
               {"own.plm", "--hdf5 confined_drive/own/../out.h5", "cannot write", 0, 2},
               {"own.plm", "--picture confined_drive/out.png", "cannot write", 0, 2}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    char arguments[256], law_text[512];
    snprintf(law_text, sizeof law_text,
             ANSWER "  include \"%s\"\n  force N = 3 [kN]*stretch\nend model\n", cases[k].include);
    write_file("confined_drive/own/answer.plm", law_text);
    snprintf(arguments, sizeof arguments, "drive confined_drive/own/path.nml %s", cases[k].options);
    expect(arguments, cases[k].free, "1 s");
    strcat(arguments, " --confined");
    expect(arguments, cases[k].confined, cases[k].part);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_failed_expectation_is_status_2),
      cmocka_unit_test(the_first_of_equal_peaks_counts),
      cmocka_unit_test(a_fall_of_the_dissipation_is_explained),
      cmocka_unit_test(closed_forms_see_the_row),
      cmocka_unit_test(a_missed_peak_says_where_it_may_lie),
      cmocka_unit_test(the_printed_rows_have_the_corners),
      cmocka_unit_test(wide_tables_go_on_below),
      cmocka_unit_test(single_neighbours_of_many_are_left_out),
      cmocka_unit_test(bad_paths_are_explained),
      cmocka_unit_test(pieces_add_up),
      cmocka_unit_test(times_meet_corners),
      cmocka_unit_test(a_table_comes_from_a_file),
      cmocka_unit_test(a_rate_may_be_given),
      cmocka_unit_test(damage_may_be_there_at_the_start),
      cmocka_unit_test(results_can_be_read),
      cmocka_unit_test(what_is_no_number_is_named),
      cmocka_unit_test(a_failing_run_leaves_its_bond),
      cmocka_unit_test(a_particle_is_driven_by_strains),
      cmocka_unit_test(the_lattice_says_where_a_particle_is),
      cmocka_unit_test(the_reference_is_true),
      cmocka_unit_test(info_says_what_a_law_implies),
      cmocka_unit_test(a_rejected_law_is_named),
      cmocka_unit_test(a_formula_with_holes_is_named),
      cmocka_unit_test(a_law_with_holes_is_not_driven),
      cmocka_unit_test(confined_drives_keep_to_their_folder),
      cmocka_unit_test(info_refuses),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
