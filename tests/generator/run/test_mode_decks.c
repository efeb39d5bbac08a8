/* Frequencies of the examples as their pages and the reference print them, and decks whose end and
   damping hang on them: what is said, runs and solvers. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <math.h>

#include <cmocka.h>

#include "tests/generator/command_tools.h"

#define ONE(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)
#define EXAMPLES  SOURCE_DIR "/examples/"

/* As held, or without the line of the drive: periods in ms behind frequencies. */
static void the_pages_have_the_modes_of_the_examples(void **state) {
  workplace *w = *state;
  static const struct {
    const char *deck;
    bool free;
    const char *lines[2];
  } pages[] = {{"tension/rot0",
                false,
                {"     1       1933.59      0.517173", "     3       5809.79      0.172123"}},
               {"tension/rot0",
                true,
                {"     1        1183.8      0.844734", "     2       2777.02      0.360099"}},
               {"dog_bone/b_s4",
                true,
                {"     1       2346.64       0.42614", "     2        5972.1      0.167445"}},
               {"dog_bone/d_s8",
                true,
                {"     1       587.392       1.70244", "     2       1470.62      0.679986"}}};
  for (size_t k = 0; k < sizeof pages / sizeof *pages; k++) {
    const char *taken_out = pages[k].free ? "/^&drive/d" : "";
    assert_int_equal(shell(w, "sed '%s' " EXAMPLES "%s.nml > deck.nml", taken_out, pages[k].deck),
                     0);
    expect(w, "info deck.nml --modes 3", 0, pages[k].lines[0]);
    if (!strstr(w->said, pages[k].lines[1])) fail_msg("no %s in %s", pages[k].lines[1], w->said);
  }
  expect(
      w, "info " EXAMPLES "notched_beam/d3_s6.35.nml --modes 3", 0,
      "  modes      the lowest 3; 1523 components of particles can move, nothing of them without "
      "resistance\n"
      "  mode  frequency/Hz     period/ms   omega/(1/s)       x %       y % turning %  residual\n"
      "     1       1788.81      0.559032       11239.4      96.4       3.5       0.0 ");
  expect(w, "info " EXAMPLES "wave_in_a_bar/joint.nml --modes 1", 0,
         "1600 components of particles can move, 12 or more motions of them without resistance");
}

static void a_run_takes_its_end_and_damping_from_them(void **state) {
  workplace *w = *state;
  static const char said[] =
      "  periods    100 of 0.517173 ms, mode 1 at 1933.59 Hz\n"
      "  damping    0.2 of the critical one of mode 1 at 1933.59 Hz: rate 4859.64 1/s\n";
#define PRISM                                                                                      \
  EXAMPLES "tension/rot0.nml --set damping.rate= --set damping.ratio=0.2 --set "                   \
           "output.result=a.h5 "
  expect(w, "info " PRISM "--set 'simulation.end_time=100 periods'", 0, said);
  expect(w, "run " PRISM "--set 'simulation.end_time=1 period' --set output.sample=", 0,
         "0.517173 ms in 1128 steps");
  expect(w,
         "run " EXAMPLES "tension/rot0.nml --set 'damping.rate=4859.6417 1/s' --set "
         "output.result=b.h5 --set 'simulation.end_time=0.517173 ms' --set output.sample=",
         0, "0.517173 ms in 1128 steps");
  expect(w, "compare a.h5 b.h5 --tolerance 1e-5", 0, "");
}

static void solvers_find_them_too(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "sed \"s/'1 ms'/'2 periods'/; $ a &damping ratio = 0.1 /\" beam.nml > "
                            "swing.nml"),
                   0);
  expect(w, "run swing.nml --set output.result=swing.h5", 0,
         "  damping    0.1 of the critical one");
#if defined(__SANITIZE_ADDRESS__)
  skip(); /* the solver's compiler does not know the sanitizers that the libraries were made with */
#endif
  expect(w, "build swing.nml -o swing", 0, "written swing");
  assert_int_equal(shell(w, "./swing --set output.result=solver.h5 > said"), 0);
  expect(w, "compare swing.h5 solver.h5", 0, "");
}

/* A bar of that many springs between equal masses, the first held, across nothing resists. */
enum { SPRINGS = 40, MODES = 3 };
static const char bar_deck[] =
    "&simulation  end_time = '1 ms'  /\n"
    "&lattice     name = 'c'  kind = 'hexagonal'  spacing = '10 mm'  thickness = '0.1 m'  /\n"
    "&material    lattice = 'c'  model = 'elastic_central'  E = '30 GPa'  /\n"
    "&body        lattice = 'c'  shape = 'rectangle'  corner = 0, -0.001  size = 0.4, 0.002  /\n"
    "&region      name = 'left'  shape = 'point'  at = 0, 0  /\n"
    "&support     region = 'left'  fix = 'x'  /\n"
    "&output      result = 'bar.h5'  /\n";

/* sin((k - 1/2) pi i / (n + 1/2)) at particle i, but for the sign; the largest 1 % of 0.4 m. */
static double exact(int number, long i) {
  double most = 0;
  for (int n = 0; n <= SPRINGS; n++)
    most = fmax(most, fabs(sin((number - 0.5) * M_PI * n / (SPRINGS + 0.5))));
  return 0.004 * sin((number - 0.5) * M_PI * (double)i / (SPRINGS + 0.5)) / most;
}

static void shapes_are_frames_of_a_result(void **state) {
  workplace *w = *state;
  write_text(w, "bar.nml", bar_deck);
  expect(w, "info bar.nml --modes 3 -o shapes.h5", 0, "  written    shapes.h5 (3 frames)");
  result_file *f = open_result_of(w, "shapes.h5");
  double *u[MODES];
  long count, frames;
  int components, dimensions;
  char unit_text[64], error[1000];
  double *places = result_read_reference(f, &count, &dimensions),
         *numbers = result_read_frame_times(f, &frames);
  assert_int_equal(count, SPRINGS + 1);
  assert_int_equal(frames, MODES);
  for (int k = 0; k < MODES; k++) {
    assert_true(numbers[k] == k + 1);
    u[k] = result_read_frame(f, "displacement", k, &count, &components, unit_text, sizeof unit_text,
                             error, sizeof error);
    assert_non_null(u[k]);
    assert_int_equal(components, 2);
    const double sign = u[k][2] < 0 ? -1 : 1; /* all begin upwards */
    for (long p = 0; p < count; p++) {
      const double wanted = exact(k + 1, lround(places[2 * p] / 0.01));
      if (!(fabs(sign * u[k][2 * p] - wanted) < 1e-7))
        fail_msg("mode %d, particle %ld: %g, not %g", k + 1, p, u[k][2 * p], wanted);
    }
  }
  /* All masses are alike. */
  for (int k = 1; k < MODES; k++) {
    double product = 0;
    for (long p = 0; p < 2 * count; p++)
      product += u[0][p] * u[k][p];
    assert_true(fabs(product) < 1e-6 * 0.004 * 0.004 * SPRINGS);
  }
  double *frequency =
      result_read_series(f, "frequency", &frames, unit_text, sizeof unit_text, error, sizeof error);
  assert_non_null(frequency);
  assert_int_equal(frames, MODES);
  assert_string_equal(unit_text, "Hz");
  /* Of n springs: in the ratio of the sines. */
  assert_true(fabs(frequency[1] / frequency[0] * sin(0.25 * M_PI / (SPRINGS + 0.5)) /
                       sin(0.75 * M_PI / (SPRINGS + 0.5)) -
                   1) < 2e-5);
  for (int k = 0; k < MODES; k++)
    free(u[k]);
  free(places);
  free(numbers);
  free(frequency);
  result_read_close(f);
}

static void shapes_are_drawn_and_spare_inputs(void **state) {
  workplace *w = *state;
  write_text(w, "bar.nml", bar_deck);
  expect(w, "info bar.nml --modes 2 --json -o shapes.h5", 0, "\"result\": \"shapes.h5\"");
  expect(w, "info shapes.h5", 0, "time                       1      from 1 to 2, last 2");
  expect(w, "plot shapes.h5 --map displacement --frame 0 -o map.svg", 0, "written map.svg");
  assert_true(exists(w, "shapes.xdmf"));
  expect(w, "info bar.nml --modes 2 -o bar.nml", 1, "the result would overwrite `bar.nml`");
  expect(w, "info bar.nml --modes 2 -o none/shapes.h5", 1, "cannot write the result");
  expect(w, "info bar.nml -o shapes.h5", 1, "add --modes N");
  expect(w, "info shapes.h5 -o other.h5", 1, "-o is for the shapes of a deck's modes");
  expect(w, "info beam.nml --modes 1", 0, "mode  frequency/Hz");
  if (exists(w, "beam.h5") || exists(w, "other.h5")) fail_msg("a result nobody has asked for");
}

static void meshes_have_none(void **state) {
  workplace *w = *state;
  expect(w,
         "check " EXAMPLES "tension/rot0_continuum.nml --set damping.rate= --set damping.ratio=0.2",
         1, "the bodies have no frequency to go by: modes of meshes are not sought");
  expect(w, "info " EXAMPLES "tension/rot0_continuum.nml --modes 1", 1,
         "has no modes: modes of meshes are not sought");
}

int main(void) {
  const struct CMUnitTest tests[] = {ONE(the_pages_have_the_modes_of_the_examples),
                                     ONE(a_run_takes_its_end_and_damping_from_them),
                                     ONE(solvers_find_them_too),
                                     ONE(shapes_are_frames_of_a_result),
                                     ONE(shapes_are_drawn_and_spare_inputs),
                                     ONE(meshes_have_none)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
