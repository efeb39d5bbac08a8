/* Loading in stages: a run that begins from another one's result. Two stages are one run to the last
   bit where nothing changes; cut-outs, damage and energies; what a deck may not begin from. */
#define _GNU_SOURCE /* nftw */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "runtime/result/result_state.h"
#include "runtime/result/state_write.h"
#include "tests/generator/command_tools.h"
#include "tests/generator/run/wrong_decks.h"

#define BLOCK(lattice, model, body)                                                                \
  "&lattice   name = 'c'  " lattice "  thickness = '50 mm'  /\n"                                   \
  "&material  lattice = 'c'  " model "  /\n"                                                       \
  "&body      lattice = 'c'  shape = 'rectangle'  corner = 0, 0  " body "  /\n"                    \
  "&region    name = 'foot'  shape = 'rectangle'  corner = '-1 mm', '-1 mm'  size = '4 mm', "      \
  "'40 mm'  /\n"                                                                                   \
  "&region    name = 'tip'  shape = 'rectangle'  corner = '54 mm', '-1 mm'  size = '10 mm', '40 "  \
  "mm'  /\n"                                                                                       \
  "&support   region = 'foot'  fix = 'xy'  /\n"                                                    \
  "&monitor   name = 'u'  kind = 'displacement'  region = 'tip'  component = 'y'  /\n"

#define HEXAGON "kind = 'hexagonal'  spacing = '5 mm'"
#define BEAM    "size = '60 mm', '26 mm'"
#define STEADY                                                                                     \
  "&damping   rate = 300  /\n&gravity   acceleration = 5, -9.81  /\n"                              \
  "&force     region = 'tip'  component = 'y'  total = '-400 N'  history = 'constant'  /\n"

enum { DECK = 4000 };

static void write_stage(const workplace *w, const char *name, const char *block, const char *end,
                        const char *more) {
  char deck[DECK], file[100];
  const int n = snprintf(
      deck, sizeof deck,
      "&simulation  end_time = '%s'  step = '0.25 us'  /\n%s%s"
      "&output  result = '%s.h5'  frames = 1  state = .true.  fields = 'damage', 'velocity'  /\n",
      end, block, more, name);
  assert_true(n > 0 && n < DECK);
  snprintf(file, sizeof file, "%s.nml", name);
  write_text(w, file, deck);
}

static void run_stage(workplace *w, const char *name) {
  char arguments[200];
  snprintf(arguments, sizeof arguments, "run %s.nml", name);
  expect(w, arguments, 0, "written");
}

static result_state *state_of(const workplace *w, const char *name) {
  char error[500] = "", file[100];
  bool missing;
  snprintf(file, sizeof file, "%s.h5", name);
  result_file *f = open_result_of(w, file);
  result_state *s = result_state_read(f, &missing, error, sizeof error);
  if (!s) print_message("%s %s\n", name, error);
  assert_non_null(s);
  result_read_close(f);
  return s;
}

static double largest(const double *values, long count) {
  double most = 0;
  for (long k = 0; k < count; k++)
    most = fmax(most, fabs(values[k]));
  return most;
}

/* Places, velocities, states and damage at the end of both, to the bit; returns the largest damage
   or state. */
static double same_ends(const workplace *w, const char *one, const char *two) {
  result_state *a = state_of(w, one), *b = state_of(w, two);
  double most = 0;
  assert_int_equal(a->body_count, b->body_count);
  for (int k = 0; k < a->body_count; k++) {
    const long count = a->bodies[k].count * a->bodies[k].dof;
    const size_t bytes = (size_t)count * sizeof(double);
    assert_int_equal(b->bodies[k].count, a->bodies[k].count);
    assert_true(largest(a->bodies[k].velocity, count) > 0);
    assert_memory_equal(a->bodies[k].displacement, b->bodies[k].displacement, bytes);
    assert_memory_equal(a->bodies[k].velocity, b->bodies[k].velocity, bytes);
  }
  assert_int_equal(a->law_count, b->law_count);
  for (int n = 0; n < a->law_count; n++)
    for (int f = 0; f < a->laws[n].field_count; f++) {
      const state_field *x = &a->laws[n].fields[f], *y = &b->laws[n].fields[f];
      const long count = x->count * x->columns;
      assert_true(x->count == y->count && x->columns == y->columns);
      assert_memory_equal(x->values, y->values, (size_t)count * sizeof(double));
      most = fmax(most, largest(x->values, count));
    }
  result_state_free(a);
  result_state_free(b);
  return most;
}

/* --- two stages are one run ------------------------------------------------------------------- */

/* Returns the largest damage. */
static double check_stages(workplace *w, const char *block, const char *more) {
  char second[2000];
  write_stage(w, "one", block, "0.6 ms", more);
  write_stage(w, "first", block, "0.25 ms", more);
  snprintf(second, sizeof second, "%s&start  result = 'first.h5'  /\n", more);
  write_stage(w, "second", block, "0.35 ms", second);
  run_stage(w, "one");
  run_stage(w, "first");
  run_stage(w, "second");
  const double damage = same_ends(w, "one", "second");
  print_message("the same bits, with a damage or state of up to %.3g\n", damage);
  return damage;
}

static void two_stages_are_one_run(void **state) {
  workplace *w = *state;
  assert_true(check_stages(w, BLOCK(HEXAGON, "model = 'mplm_bilinear'", BEAM), STEADY) > 0.5);
  assert_true(check_stages(w, BLOCK(HEXAGON, "model = 'splm_concrete'", BEAM), STEADY) > 0);
  assert_true(check_stages(w,
                           BLOCK("kind = 'square'  spacing = '5 mm'  horizon = 2.015",
                                 "model = 'pmb'  G_0 = '0.02 N/m'", BEAM),
                           STEADY) > 0);
  assert_true(check_stages(w, BLOCK("kind = 'blue_noise'  spacing = '5 mm'", "model = 'lps'", BEAM),
                           STEADY) >= 0);
}

/* Of two blocks that are not joined one is cut out: the other one moves as if it had always been
   alone. */
static void what_is_cut_out_takes_nothing_along(void **state) {
  workplace *w = *state;
  static const char alone[] = BLOCK(HEXAGON, "model = 'mplm_bilinear'", BEAM) STEADY,
                    far[] = "&body  lattice = 'c'  shape = 'rectangle'  corner = '-90 mm', '-60 "
                            "mm'  size = '40 mm', '50 mm'  /\n";
  write_stage(w, "one", alone, "0.6 ms", "");
  write_stage(w, "first", alone, "0.25 ms", far);
  write_stage(w, "second", alone, "0.35 ms", "&start  result = 'first.h5'  /\n");
  run_stage(w, "one");
  run_stage(w, "first");
  run_stage(w, "second");
  assert_non_null(strstr(w->said, " go on; "));
  assert_non_null(strstr(w->said, " are gone"));
  assert_null(strstr(w->said, " new"));
  assert_true(same_ends(w, "one", "second") > 0.5);
  /* and the other way round: what is new is at rest, and sets nothing in motion */
  write_stage(w, "first", alone, "0.25 ms", "");
  char more[1000];
  snprintf(more, sizeof more, "%s&start  result = 'first.h5'  /\n", far);
  write_stage(w, "second", alone, "0.35 ms", more);
  run_stage(w, "first");
  run_stage(w, "second");
  assert_non_null(strstr(w->said, " are new"));
  result_state *one = state_of(w, "one"), *two = state_of(w, "second");
  assert_true(two->bodies[0].count > one->bodies[0].count);
  const double far_below = largest(two->bodies[0].displacement, 2);
  assert_true(far_below > 0); /* its weight */
  result_state_free(one);
  result_state_free(two);
}

/* --- at rest ---------------------------------------------------------------------------------- */

static double last_of(const workplace *w, const char *name, const char *series, bool first) {
  char file[100], in[64], error[500] = "";
  long count;
  snprintf(file, sizeof file, "%s.h5", name);
  result_file *f = open_result_of(w, file);
  double *values = result_read_series(f, series, &count, in, sizeof in, error, sizeof error);
  if (!values) print_message("%s\n", error);
  assert_non_null(values);
  const double value = values[first ? 0 : count - 1];
  free(values);
  result_read_close(f);
  return value;
}

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
  assert_true(fabs(last_of(w, "second", "energy/imbalance", false)) < 1e-12 * size);
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
    {"name", "name = 'c'", "name = 'c'  spacing = 3", false},
    {"velocity", "&start",
     "&initial_velocity  region = 'tip'  component = 'x'  value = 1  /\n&start", false},
    {"contact", "&start", "&contact  /\n&start", false},
    {"itself", "second.h5", "first.h5", false},
    {"nothing", "result = 'first.h5'", "", false},
    {"mesh", "&start",
     "&mesh  name = 'm'  corner = 1, 0  size = 1, 1  nodes = 3, 3  thickness = 1  /\n"
     "&material  mesh = 'm'  model = 'elastic'  /\n&start",
     false},
};

static void wrong_starts_are_told(void **state) {
  workplace *w = *state;
  write_stage(w, "first", BLOCK(HEXAGON, "model = 'mplm_bilinear'", BEAM), "10 us", STEADY);
  run_stage(w, "first");
  expect(w, "run first.nml --set output.state=.false. --set output.result=frames.h5", 0, "written");
  assert_int_equal(shell(w, "head -c 9000 first.h5 > damaged.h5"), 0);
  check_faults(w, SOURCE_DIR "/tests/generator/run/bad_stages", "second.nml", faults,
               sizeof faults / sizeof *faults);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(two_stages_are_one_run, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(what_is_cut_out_takes_nothing_along, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_hole_may_be_cut_after_loading, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(balance_stays, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(energies_go_on, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_drive_begins_where_it_finds_its_particles, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_stage_may_have_another_step, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(wrong_starts_are_told, set_up_workplace, tear_down_workplace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
