/* Laws of cracks in a run: as those of bodies they are in results, in solvers, in what a checkpoint
   belongs to, and in the comparison of kernels with the interpreter. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/command_tools.h"

static int set_up_plate(void **state) {
  const int failed = set_up_workplace(state);
  if (failed) return failed;
  return shell(*state,
               "cp " SOURCE_DIR "/tests/generator/run/bad_meshes/plate.nml . && cp " SOURCE_DIR
               "/models/lefm.plm my_crack.plm && sed -i \"s/'lefm'/'.\\/my_crack.plm'  K_Ic = "
               "'0.1 MPa*m^(1\\/2)'/\" plate.nml");
}

static void a_solver_has_them_built_in(void **state) {
  workplace *w = *state;
#if defined(__SANITIZE_ADDRESS__)
  skip(); /* its libraries need the sanitizer's */
#endif
  expect(w, "run plate.nml --set output.result=run.h5", 0, "written");
  expect(w, "build plate.nml -o plate", 0, "without a compiler");
  assert_int_equal(shell(w, "mv my_crack.plm away.plm && ./plate"), 0);
  expect(w, "compare run.h5 plate.h5", 0, "none differs by more than 0");
  assert_int_equal(shell(w, "./plate --set crack.K_Ic=-1"), 1);
  assert_non_null(strstr(w->said, "is not in (0, inf)"));
}

static void results_hold_their_text(void **state) {
  workplace *w = *state;
  expect(w, "run plate.nml", 0, "written");
  assert_int_equal(shell(w, "grep -aq 'grow when K_eq' plate.h5"), 0);
  assert_int_equal(shell(w, "grep -aq 'stress sigma = hooke' plate.h5"), 0);
}

/* A run goes on with the laws that it began with. */
static void another_law_cannot_resume(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "sed -e 's/50 us/50 ms/' -e 's/frames = 4/frames = 1000/' plate.nml > "
                            "long.nml"),
                   0);
  const pid_t run = start_long_run(w, "long.h5", NULL);
  assert_int_equal(kill(run, SIGINT), 0);
  assert_int_equal(end_of(run), 130);
  assert_int_equal(shell(w, "sed -i 's/K_eq >= K_Ic/K_eq >= 2*K_Ic/' my_crack.plm"), 0);
  expect(w, "run long.nml --set output.result=long.h5 --set 'simulation.title=a long run' --resume",
         1, "belongs to another deck, law or kernel");
}

static void kernels_are_compared(void **state) {
  workplace *w = *state;
  expect(w, "run plate.nml --check-kernel", 0,
         "kernel check: lefm and its interpreter give the same");
}

/* A monitor of a tip has the values of its history, and ends the run. */
static void monitors_watch_tips(void **state) {
  workplace *w = *state;
  char error[1000], unit_text[64];
  long count[2];
  assert_int_equal(shell(w, "echo \"&monitor name = 'K' kind = 'crack' crack = 'c' value = 'K_I' / "
                            "&monitor name = 'way' kind = 'crack' crack = 'c' value = 'length' "
                            "zero_at = 0 / &stop monitor = 'way' above = '2 mm' /\" >> plate.nml"),
                   0);
  expect(w, "run plate.nml", 0, "ended early");
  result_file *f = open_result_of(w, "plate.h5");
  double *seen =
      result_read_series(f, "K", &count[0], unit_text, sizeof unit_text, error, sizeof error);
  double *kept =
      result_read_series(f, "c/K_I", &count[1], unit_text, sizeof unit_text, error, sizeof error);
  assert_non_null(seen);
  assert_non_null(kept);
  assert_string_equal(unit_text, "Pa*sqrt(m)");
  assert_true(count[0] > 1 && count[0] == count[1] && kept[count[1] - 1] != 0);
  assert_memory_equal(seen, kept, (size_t)count[0] * sizeof *seen);
  free(seen);
  free(kept);
  result_read_close(f);
  assert_int_equal(shell(w, "sed -i \"s/crack = 'c' value/crack = 'd' value/\" plate.nml && $P "
                            "check plate.nml"),
                   1);
  assert_non_null(strstr(w->said, "there is no tip `d`"));
}

/* Wherever cracks may grow, beyond the mesh there is nothing. */
static void tips_end_with_the_mesh(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w,
                         "sed -i -e \"s/check_steps = 10/check_steps = 10  corner = -1, -1  size = "
                         "2, 2/\" -e \"s/50 us/150 us/\" -e \"s/K_Ic = '0.1/v_0 = '1000 "
                         "m\\/s'  K_Ic = '0.1/\" plate.nml"),
                   0);
  expect(w, "run plate.nml", 0, "mm has left where cracks grow at");
  assert_int_equal(
      shell(w, "$P export plate.h5 --history c/x | awk -F, 'NR > 1 && $2 > 0.1 {exit 1}'"), 0);
}

/* A crack drawn in two legs on one line is the same crack. */
static void legs_in_line_are_one(void **state) {
  workplace *w = *state;
  assert_int_equal(
      shell(w, "sed -i \"s/K_Ic = '0.1/K_Ic = '100/\" plate.nml && sed \"s/points = 0, '31 mm', "
               "/&'29.7 mm', '31 mm', /\" plate.nml > legs.nml"),
      0);
  expect(w, "run plate.nml --set output.result=one.h5", 0, "at the last look K_I = ");
  expect(w, "run legs.nml --set output.result=two.h5", 0, "at the last look K_I = ");
  expect(w, "compare one.h5 two.h5 --history c/K_I --tolerance 1e-6", 0, "same");
}

/* A step that was stable before the crack had grown. */
static void growth_may_ask_for_shorter_steps(void **state) {
  workplace *w = *state;
  assert_int_equal(shell(w, "sed -i -e \"s/50 us/120 us/\" -e \"s/K_Ic = '0.1/v_0 = '1000 m\\/s'  "
                            "K_Ic = '0.1/\" plate.nml"),
                   0);
  expect(w, "run plate.nml --set simulation.step_safety=0.95", 2,
         "since the cracks of `plate` have grown its longest stable step is");
  expect(w, "run plate.nml --set simulation.step_safety=0.25", 0, "written");
  assert_null(strstr(w->said, "longest stable step"));
}

int main(void) {
#define T(test) cmocka_unit_test_setup_teardown(test, set_up_plate, tear_down_workplace)
  const struct CMUnitTest tests[] = {T(a_solver_has_them_built_in),
                                     T(results_hold_their_text),
                                     T(another_law_cannot_resume),
                                     T(kernels_are_compared),
                                     T(monitors_watch_tips),
                                     T(tips_end_with_the_mesh),
                                     T(growth_may_ask_for_shorter_steps),
                                     T(legs_in_line_are_one)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
