/* A deck that gives a law's field, wrong in one place at a time, and the exact text that a user
   sees of each: bad_fields/bar.nml, and a text for each fault. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/run/wrong_decks.h"

#define GIVEN "value = '293 [K] + 100 [K]*x/1 [m]'"

static const fault faults[] = {
    {"no_such", "name = 'T'", "name = 'Temp'", false},
    {"parameter", "name = 'T'", "name = 'E_20'", false},
    {"at_random", "name = 'T'", "parameter = 'T'", false},
    {"unit", GIVEN, "value = '293 [N] + 100 [N]*x/1 [m]'", false},
    {"number_unit", GIVEN, "value = '293 mm'", false},
    {"unknown_name", GIVEN, "value = '293 [K] + 100 [K]*r/1 [m]'", false},
    {"range", GIVEN, "value = '293 [K] - 4000 [K]*x/1 [m]'", false},
    {"range_in_time", GIVEN, "value = '293 [K]*(1 - 2*t/1 [ms])'", false},
    {"not_finite", GIVEN, "value = '293 [K]*x/x'", false},
    {"not_rising", GIVEN, "times = 0, '2 ms', '1 ms'  values = '293 K', '300 K', '400 K'", false},
    {"one_less", GIVEN, "times = 0, '2 ms'  values = '293 K', '300 K', '400 K'", false},
    {"no_values", GIVEN, "times = 0, '2 ms'", false},
    {"two_units", GIVEN, "times = 0, '2 ms'  values = '293 K', '300 mm'", false},
    {"table_unit", GIVEN, "times = 0, '2 ms'  values = '293 mm', '300 mm'", false},
    {"table_range", GIVEN, "times = 0, '2 ms'  values = '293 K', '-300 K'", false},
    {"both", GIVEN, GIVEN "  file = 'grid.csv'", false},
    {"nothing", GIVEN, "", false},
    {"nameless", "name = 'T'  " GIVEN, GIVEN, false},
    {"twice", "\n\n", "\n&field  name = 'T'  value = '300 K' /\n", false},
    {"material_too", "model = './heated.plm'", "model = './heated.plm'  T = '300 K'", false},
    {"no_lattice", "name = 'T'", "name = 'T'  lattice = 'rod'", false},
    {"no_file", GIVEN, "file = 'none.csv'", false},
    {"hole", GIVEN, "file = 'hole.csv'", false},
    {"double", GIVEN, "file = 'double.csv'", false},
    {"short", GIVEN, "file = 'short.csv'", false},
    {"column", GIVEN, "file = 'short.csv:T2'", false},
    {"damaged", GIVEN, "file = 'damaged.csv'", false},
    {"file_unit", GIVEN, "file = 'metres.csv'", false},
    {"time_falls", GIVEN, "table = 'falls.csv'", false},
    {"time_unit", GIVEN, "table = 'metres.csv:x,T'", false},
};

static void write_files(const workplace *w) {
  write_text(w, "heated.plm",
             "model heated\n"
             "  law central bond\n"
             "  parameter E_20 = 30 [GPa] in (0, inf)\n"
             "  parameter rho = 2323 [kg/m^3] in (0, inf)\n"
             "  field T [K] on particle = 293 [K] in (0, inf)\n"
             "  force N = E_20*area*stretch*293 [K]/T\n"
             "end model\n");
  write_text(w, "grid.csv", "x [mm], y [mm], T [K]\n0, 0, 293\n100, 0, 393\n");
  write_text(w, "hole.csv", "x [mm], y [mm], T [K]\n0, -1, 293\n100, -1, 393\n0, 1, 293\n");
  write_text(w, "double.csv", "x [mm], y [mm], T [K]\n0, 0, 293\n100, 0, 393\n100, 0, 400\n");
  write_text(w, "short.csv", "x [mm], y [mm], T [K]\n0, 0, 293\n50, 0, 393\n");
  write_text(w, "damaged.csv", "x [mm], y [mm], T [K]\n0, 0, 293\n100, 0, 39e\n");
  write_text(w, "metres.csv", "x [mm], y [mm], T [mm]\n0, 0, 293\n100, 0, 393\n");
  write_text(w, "falls.csv", "time [ms], T [K]\n0, 293\n2, 300\n1, 400\n");
}

static void what_is_wrong_is_told(void **state) {
  workplace *w = *state;
  write_files(w);
  check_faults(w, SOURCE_DIR "/tests/generator/run/bad_fields", "bar.nml", faults,
               sizeof faults / sizeof *faults);
}

/* The deck itself is right, and so are the files that are not meant to be wrong. */
static void what_is_right_is_run(void **state) {
  workplace *w = *state;
  write_files(w);
  char *deck = fault_text(SOURCE_DIR "/tests/generator/run/bad_fields", "bar.nml", "");
  write_text(w, "bar.nml", deck);
  expect(w, "run bar.nml", 0, "T differs from place to place: 293.5 to 302.5 K");
  write_wrong(w, "bar.nml", deck, &(fault){"", GIVEN, "file = 'grid.csv'", false});
  expect(w, "run bar.nml", 0, "T differs from place to place: 298 to 388 K");
  free(deck);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(what_is_wrong_is_told, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(what_is_right_is_run, set_up_workplace, tear_down_workplace)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
