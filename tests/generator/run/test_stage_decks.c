/* Stages whose decks differ: holes, drives and steps; what stands in balance, energies; what a run
   may not begin from. */
#define _GNU_SOURCE /* nftw */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/result/result_fields.h"
#include "tests/generator/run/stages.h"
#include "tests/generator/run/wrong_decks.h"
#include "tests/verification/page.h"

/* --- at rest ---------------------------------------------------------------------------------- */

#define RELAXED                                                                                    \
  "&relaxation  increments = 2  tolerance = 1e-6  /\n"                                             \
  "&monitor  name = 'x'  kind = 'displacement'  region = 'tip'  component = 'x'  /\n"
#define PULL(history)                                                                              \
  "&force  region = 'tip'  component = 'x'  total = '400 N'  history = " history "  /\n"
#define HOLE                                                                                       \
  "&notch  lattice = 'c'  shape = 'disc'  centre = '30 mm', '13 mm'  radius = '7 mm'  "            \
  "cut_bonds = .false.  /\n"

/* An elastic body does not remember whether a hole was cut before it was pulled or after. */
static void a_hole_may_be_cut_after_loading(void **state) {
  workplace *w = *state;
  static const char block[] = BLOCK(HEXAGON, "model = 'elastic_central'", BEAM) RELAXED;
  write_stage(w, "one", block, "1 s", HOLE PULL("'ramp'  rise = '1 s'"));
  write_stage(w, "first", block, "1 s", PULL("'ramp'  rise = '1 s'"));
  write_stage(w, "second", block, "1 s",
              HOLE PULL("'constant'") "&start  result = 'first.h5'  /\n");
  run_stage(w, "one");
  run_stage(w, "first");
  run_stage(w, "second");
  assert_non_null(strstr(w->said, " are gone"));
  const double with = last_of(w, "one", "x", false), without = last_of(w, "first", "x", false),
               cut = last_of(w, "second", "x", false), begun = last_of(w, "second", "x", true);
  print_message("pulled by %.6g um, with a hole %.6g um; cut out later %.6g um\n", 1e6 * without,
                1e6 * with, 1e6 * cut);
  assert_true(with > 1.1 * without);
  assert_true(fabs(begun - without) <= 1e-12 * without); /* the mean, without the hole's */
  assert_true(fabs(cut - with) <= 1e-4 * with);
}

/* What stood in balance stays where it is: loads that were there go on. */
static void balance_stays(void **state) {
  workplace *w = *state;
  static const char block[] = BLOCK(HEXAGON, "model = 'elastic_micropolar'", BEAM),
                    go_on[] = PULL("'constant'") "&start  result = 'first.h5'  /\n";
  char text[DECK];
  snprintf(text, sizeof text, "%s%s", block, RELAXED);
  write_stage(w, "first", text, "1 s", PULL("'ramp'  rise = '1 s'"));
  run_stage(w, "first");
  const double x = last_of(w, "first", "x", false), stored = last_of(w, "first", "stored", false);
  write_stage(w, "second", text, "1 s", go_on);
  run_stage(w, "second");
  assert_true(fabs(last_of(w, "second", "x", true) - x) == 0);
  assert_true(fabs(last_of(w, "second", "x", false) - x) <= 1e-5 * x);
  assert_true(last_of(w, "second", "dissipated_damping", false) < 1e-6 * stored); /* no swing */
  write_stage(w, "second", block, "0.2 ms", go_on); /* in steps of time */
  run_stage(w, "second");
  assert_true(fabs(last_of(w, "second", "stored", true) / stored - 1) < 1e-9);
  print_message("kinetic energy of a body in balance: %.1e of what it stores\n",
                last_of(w, "second", "kinetic", false) / stored);
  assert_true(last_of(w, "second", "kinetic", false) < 1e-9 * stored);
}

/* --- energies, drives, steps ------------------------------------------------------------------ */

static void energies_go_on(void **state) {
  workplace *w = *state;
  static const char *const held[] = {"energy/kinetic", "energy/stored"};
  check_stages(w, BLOCK(HEXAGON, "model = 'elastic_micropolar'", BEAM), STEADY);
  double size = 0;
  for (int k = 0; k < 2; k++) {
    const double before = last_of(w, "first", held[k], false);
    assert_true(before > 0);
    size += before;
    assert_true(fabs(last_of(w, "second", held[k], true) / before - 1) < 1e-12);
    assert_true(last_of(w, "second", held[k], false) == last_of(w, "one", held[k], false));
  }
  const double work = last_of(w, "first", "energy/external", false) +
                      last_of(w, "second", "energy/external", false),
               whole = last_of(w, "one", "energy/external", false);
  print_message("imbalance %.1e of the energy, work %.1e off that of one run\n",
                last_of(w, "second", "energy/imbalance", false) / size, work / whole - 1);
  assert_true(last_of(w, "second", "energy/external", true) == 0);
  assert_true(fabs(last_of(w, "second", "energy/imbalance", false)) < 1e-10 * size);
  assert_true(fabs(work / whole - 1) < 1e-11);
}

#define DRIVEN(velocity, more)                                                                     \
  "&drive  region = 'tip'  component = 'y'  velocity = '" velocity " mm/s'  " more "  /\n"         \
  "&monitor  name = 'r'  kind = 'reaction'  region = 'tip'  component = 'y'  /\n"

/* From where its particles are; one that goes on as before exerts what it did. */
static void a_drive_begins_where_it_finds_its_particles(void **state) {
  workplace *w = *state;
  static const char block[] = BLOCK(HEXAGON, "model = 'mplm_bilinear'", BEAM);
  write_stage(w, "one", block, "0.6 ms", DRIVEN("-80", "rise = '0.1 ms'"));
  write_stage(w, "first", block, "0.25 ms", DRIVEN("-80", "rise = '0.1 ms'"));
  write_stage(w, "second", block, "0.35 ms", DRIVEN("-80", "") "&start  result = 'first.h5'  /\n");
  run_stage(w, "one");
  run_stage(w, "first");
  run_stage(w, "second");
  const double u = last_of(w, "one", "u", false), r = last_of(w, "one", "r", false);
  assert_true(last_of(w, "second", "u", true) == last_of(w, "first", "u", false));
  assert_true(fabs(last_of(w, "second", "u", false) / u - 1) < 1e-12);
  print_message("reaction %.6g N, in stages %.1e off\n", r,
                last_of(w, "second", "r", false) / r - 1);
  assert_true(fabs(last_of(w, "second", "r", false) / r - 1) < 1e-8);
}

/* The velocity is put right for another step: what is left falls with its square. */
static void a_stage_may_have_another_step(void **state) {
  workplace *w = *state;
  static const char block[] = BLOCK(HEXAGON, "model = 'elastic_micropolar'", BEAM) STEADY;
  write_stage(w, "one", block, "0.6 ms", "");
  write_stage(w, "first", block, "0.25 ms", "");
  write_stage(w, "second", block, "0.35 ms", "&start  result = 'first.h5'  /\n");
  run_stage(w, "one");
  run_stage(w, "first");
  expect(w, "run second.nml --set 'simulation.step=0.05 us'", 0, "written");
  const double u = last_of(w, "one", "u", false);
  print_message("another step: %.1e off\n", last_of(w, "second", "u", false) / u - 1);
  assert_true(last_of(w, "second", "u", false) != u);
  assert_true(fabs(last_of(w, "second", "u", false) / u - 1) < 2e-4);
}

/* --- the example ------------------------------------------------------------------------------ */

static const char tunnel_page[] = "examples/stages/README.md";

static void closure_is(workplace *w, const char *result, const char *line, const char *format) {
  char figure[64];
  snprintf(figure, sizeof figure, format, 1e3 * last_of(w, result, "closure", false));
  page_line_says(tunnel_page, line, figure);
}

/* MPa: the largest pressure along y. */
static double pressure_of(const workplace *w, const char *result) {
  char unit_text[64], error[500] = "";
  long count = 0;
  int components = 0;
  double most = 0;
  result_file *f = open_result_of(w, result);
  double *stress = result_read_frame(f, "stress_yy", 1, &count, &components, unit_text,
                                     sizeof unit_text, error, sizeof error);
  assert_non_null(stress);
  for (long k = 0; k < count; k++)
    most = fmax(most, -1e-6 * stress[k]);
  free(stress);
  result_read_close(f);
  return most;
}

static void the_tunnel_is_as_its_page_says(void **state) {
  workplace *w = *state;
  char figure[64];
  expect(w, "run " SOURCE_DIR "/examples/stages/rock.nml", 0, "written");
  expect(w, "run " SOURCE_DIR "/examples/stages/tunnel.nml", 0,
         "18648 particles and 55338 bonds go on; 241 particles and 780 bonds are gone");
  assert_int_equal(
      shell(w, "sed '/&start/d' " SOURCE_DIR "/examples/stages/tunnel.nml > at_once.nml"), 0);
  expect(w, "run at_once.nml --set output.result=at_once.h5", 0, "written");
  closure_is(w, "rock", "| before the tunnel |", " %.4f |");
  closure_is(w, "tunnel", "| with the tunnel, cut out", " %.5f |");
  closure_is(w, "at_once", "| with the tunnel, there before", " %.5f |");
  snprintf(figure, sizeof figure, "bears %.1f MPa", pressure_of(w, "tunnel.h5"));
  page_line_says(tunnel_page, "The 241 particles", figure);
}

/* --- what it may not begin from --------------------------------------------------------------- */

static const fault faults[] = {
    {"no_file", "first.h5", "fist.h5", false},
    {"no_state", "first.h5", "frames.h5", false},
    {"damaged", "first.h5", "damaged.h5", false},
    {"no_result", "first.h5", "second.nml", false},
    {"law", "mplm_bilinear", "elastic_micropolar", false},
    {"components", "mplm_bilinear", "elastic_central", false},
    {"kind", "'hexagonal'", "'square'", false},
    {"spacing", "'5 mm'  thickness", "'4 mm'  thickness", false},
    {"place", "thickness", "origin = '1 mm', 0  thickness", false},
    {"name", "first.h5", "other.h5", false},
    {"broken", "first.h5", "broken.h5", false},
    {"velocity", "&start",
     "&initial_velocity  region = 'tip'  component = 'x'  value = 1  /\n&start", false},
    {"itself", "second.h5", "first.h5", false},
    {"nothing", "result = 'first.h5'", "", false},
    {"mesh", "&start",
     "&mesh  name = 'm'  corner = 1, 0  size = 1, 1  nodes = 3, 3  method = "
     "'finite_elements'  thickness = 1  /\n"
     "&material  mesh = 'm'  model = 'elastic'  /\n&start",
     false},
};

static void wrong_starts_are_told(void **state) {
  workplace *w = *state;
  write_stage(w, "first", BLOCK(HEXAGON, "model = 'mplm_bilinear'", BEAM), "10 us", STEADY);
  run_stage(w, "first");
  expect(w, "run first.nml --set output.state=.false. --set output.result=frames.h5", 0, "written");
  assert_int_equal(shell(w, "head -c 9000 first.h5 > damaged.h5 && cp first.h5 broken.h5 && printf "
                            "'spoilt' | dd of=broken.h5 bs=1 seek=4000 conv=notrunc"),
                   0);
  assert_int_equal(shell(w, "sed \"s/'c'/'d'/g\" first.nml > other.nml"), 0);
  expect(w, "run other.nml --set output.result=other.h5", 0, "written");
  check_faults(w, SOURCE_DIR "/tests/generator/run/bad_stages", "second.nml", faults,
               sizeof faults / sizeof *faults);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(a_hole_may_be_cut_after_loading, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(balance_stays, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(energies_go_on, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_drive_begins_where_it_finds_its_particles, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_stage_may_have_another_step, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(the_tunnel_is_as_its_page_says, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(wrong_starts_are_told, set_up_workplace, tear_down_workplace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
