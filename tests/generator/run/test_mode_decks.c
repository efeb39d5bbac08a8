/* Frequencies of the examples as their pages and the reference print them, and decks whose end and
   damping hang on them: what is said, runs and solvers. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

int main(void) {
  const struct CMUnitTest tests[] = {ONE(the_pages_have_the_modes_of_the_examples),
                                     ONE(a_run_takes_its_end_and_damping_from_them),
                                     ONE(solvers_find_them_too)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
