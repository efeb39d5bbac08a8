/* Steps that shrink: a crack that cuts nodes off, a solid that stiffens, which both go wrong with
   the step that they began with; blocks that meet late. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <unistd.h>

#include <cmocka.h>

#include "runtime/simulation/simulation_save.h"
#include "tests/runtime/same_runs.h"
#include "tests/verification/case.h"
#include "tests/verification/page.h"

/* --- a crack ---------------------------------------------------------------------------------- */

/* A plate that is torn by a crack of 1000 m/s. */
static void open_plate(deck_case *c, double part, int every, int threads) {
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = '120 us' step_safety = %g shrink_every = %d threads = %d /\n"
           "&mesh name = 'plate' size = '100 mm', '60 mm' nodes = 41, 25 thickness = '10 mm'\n"
           "      method = 'element_free' support = 2.1 /\n"
           "&zone mesh = 'plate' method = 'finite_elements' shape = 'rectangle' corner = 0, 0\n"
           "      size = '100 mm', '3 mm' /\n"
           "&material mesh = 'plate' model = 'elastic' E = '30 GPa' /\n"
           "&crack name = 'c' mesh = 'plate' points = 0, '31 mm', '30 mm', '31 mm' grows = .true.\n"
           "       model = 'lefm' v_0 = '1000 m/s' K_Ic = '0.1 MPa*m^(1/2)' /\n"
           "&tips half_size = 3 check_every = '2 us' /\n"
           "&region name = 'foot' shape = 'rectangle' corner = 0, 0 size = '100 mm', '1 mm' /\n"
           "&support region = 'foot' fix = 'x', 'y' /\n"
           "&traction mesh = 'plate' from = 0, '60 mm' to = '100 mm', '60 mm' component = 'y'\n"
           "          stress = '20 MPa' /\n"
           "&output frames = 0 sample = '2 us' /\n",
           part, every, threads);
  deck_case_open(c, text);
}

static double imbalance_of(const deck_case *c) {
  return deck_case_largest(c, "energy/imbalance") / simulation_largest_energy(c->simulation);
}

static long steps_of(const deck_case *c) {
  return simulation_steps_taken(c->simulation);
}

/* What the reference says of both. */
static void steps_are_told(const char *row, long shrinking, long that_stay) {
  char figures[64];
  snprintf(figures, sizeof figures, "| %ld | %ld |", shrinking, that_stay);
  page_line_says("runtime/README.md", row, figures);
}

static void a_crack_shortens_the_step(void **state) {
  (void)state;
  deck_case c;
  int count;
  open_plate(&c, 0.8, 0, 1);
  assert_int_equal(deck_case_go(&c), STEP_BAD);
  deck_case_close(&c);
  open_plate(&c, 0.25, 0, 1);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const long usual = steps_of(&c);
  deck_case_close(&c);
  open_plate(&c, 0.8, 10, 1);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const step_change *changes = simulation_step_changes(c.simulation, &count);
  const double falls =
      simulation_limit_now(c.simulation, 0) / simulation_step_limit(c.simulation)->limit;
  print_message(
      "cut at step %ld of %ld: %ld steps instead of %ld, the limit ends at %.2f of that at "
      "the start; imbalance %.1e\n",
      (long)changes->step, simulation_step_count(c.simulation), steps_of(&c), usual, falls,
      imbalance_of(&c));
  assert_true(count == 1 && changes->cause == STEP_CRACKED && changes->halvings == 1);
  assert_true(steps_of(&c) < 0.65 * (double)usual);
  assert_true(imbalance_of(&c) < 1e-9);
  assert_true(falls > 0.5 && falls < 0.6);
  steps_are_told("| a crack through a plate", steps_of(&c), usual);
  deck_case_close(&c);
}

static void threads_and_stops_change_no_bit(void **state) {
  (void)state;
  static const char path[] = "test_shrinking_steps.state";
  deck_case straight, other;
  char error[256];
  int count;
  open_plate(&straight, 0.8, 10, 1);
  assert_int_equal(deck_case_go(&straight), STEP_END);
  const long at = (long)simulation_step_changes(straight.simulation, &count)->step,
             stops[] = {at - 3, at, at + 1, at + 40};
  for (int k = 0; k < 4; k++) {
    open_plate(&other, 0.8, 10, 2 + k % 2);
    simulation_advance(other.simulation, stops[k], NULL);
    assert_int_equal(simulation_step_done(other.simulation), stops[k]);
    assert_true(
        simulation_save(other.simulation, path, "x", &(frame_mark){0}, error, sizeof error));
    deck_case_close(&other);
    open_plate(&other, 0.8, 10, 1 + k % 3);
    assert_true(simulation_restore(other.simulation, path, "x", NULL, error, sizeof error));
    assert_int_equal(deck_case_go(&other), STEP_END);
    same_runs(straight.simulation, other.simulation);
    deck_case_close(&other);
  }
  deck_case_close(&straight);
  unlink(path);
}

/* --- a solid that stiffens -------------------------------------------------------------------- */

#define STRUCK "examples/stiffening_bar/struck.nml"

static step_status strike(deck_case *c, double part, int every) {
  char texts[3][64] = {"drive.velocity=-40 m/s"};
  const char *overrides[3] = {texts[0], texts[1], texts[2]};
  snprintf(texts[1], sizeof *texts, "simulation.step_safety=%g", part);
  snprintf(texts[2], sizeof *texts, "simulation.shrink_every=%d", every);
  assert_true(deck_case_run(c, STRUCK, overrides, 3));
  return deck_case_go(c);
}

static void a_solid_that_stiffens_shortens_the_step(void **state) {
  (void)state;
  deck_case c;
  int count;
  assert_int_equal(strike(&c, 0.9, 0), STEP_BAD);
  deck_case_close(&c);
  assert_int_equal(strike(&c, 0.1, 0), STEP_END);
  const double far = deck_case_largest(&c, "near"), work = deck_case_last(&c, "energy/external");
  deck_case_close(&c);
  assert_int_equal(strike(&c, 0.25, 0), STEP_END);
  const long usual = steps_of(&c);
  deck_case_close(&c);
  assert_int_equal(strike(&c, 0.9, 10), STEP_END);
  const step_change *changes = simulation_step_changes(c.simulation, &count);
  print_message("shrunk %d times; largest velocity %.4f of that with short steps, work %.5f, "
                "imbalance %.1e\n",
                count, deck_case_largest(&c, "near") / far,
                deck_case_last(&c, "energy/external") / work, imbalance_of(&c));
  assert_true(count == 2 && changes[1].halvings == 2 && changes[1].cause == STEP_STIFFER);
  assert_true(fabs(deck_case_last(&c, "energy/external") / work - 1) < 2e-3);
  assert_true(imbalance_of(&c) < 5e-3);
  steps_are_told("| a bar that stiffens", steps_of(&c), usual);
  deck_case_close(&c);
}

/* --- a blow ----------------------------------------------------------------------------------- */

#define BLOCK(name, x)                                                                             \
  "&lattice name = '" name "' kind = 'hexagonal' spacing = '10 mm' thickness = '100 mm'\n"         \
  "         origin = '" x " mm', 0 /\n"                                                            \
  "&material lattice = '" name "' model = 'elastic_micropolar' E = '30 GPa' nu = 0.2\n"            \
  "          rho = '2323 kg/m^3' /\n"                                                              \
  "&body lattice = '" name "' shape = 'rectangle' corner = '" x " mm', 0\n"                        \
  "      size = '50 mm', '60 mm' /\n"

/* A millimetre apart at 10 m/s. */
static void meet(deck_case *c, double part, int every, double stiffness) {
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = '0.2 ms' step_safety = %g shrink_every = %d /\n" BLOCK("a", "0")
               BLOCK("b", "61") "&region name = 'all' lattice = 'b' shape = 'rectangle'\n"
                                "        corner = -1, -1 size = 2, 2 /\n"
                                "&initial_velocity region = 'all' component = 'x'\n"
                                "                  value = '-10 m/s' /\n"
                                "&contact stiffness = %g /\n"
                                "&monitor name = 'p' kind = 'momentum' lattice = 'a'\n"
                                "         component = 'x' /\n"
                                "&output frames = 0 sample = '2 us' /\n",
           part, every, stiffness);
  deck_case_open(c, text);
  assert_int_equal(deck_case_go(c), STEP_END);
}

static void blocks_meet_with_long_steps(void **state) {
  (void)state;
  deck_case fixed, shrinking, fine;
  meet(&fine, 0.02, 0, 2e10);
  meet(&fixed, 0.5, 0, 2e10);
  meet(&shrinking, 0.5, 50, 2e10);
  const double p = deck_case_last(&fine, "p");
  print_message(
      "momentum off by %.2e with shrinking steps, %.2e with short ones; %ld and %ld steps; "
      "imbalance %.1e and %.1e\n",
      deck_case_last(&shrinking, "p") / p - 1, deck_case_last(&fixed, "p") / p - 1,
      steps_of(&shrinking), steps_of(&fixed), imbalance_of(&shrinking), imbalance_of(&fixed));
  assert_true(fabs(deck_case_last(&shrinking, "p") / p - 1) < 1e-2);
  steps_are_told("| two blocks that meet", steps_of(&shrinking), steps_of(&fixed));
  char off[64];
  snprintf(off, sizeof off, "impulse is %.1f %% off, beside %.1f %%",
           1e2 * (1 - deck_case_last(&shrinking, "p") / p),
           1e2 * (1 - deck_case_last(&fixed, "p") / p));
  page_line_says("runtime/README.md", "| two blocks that meet", off);
  deck_case_close(&fixed);
  deck_case_close(&shrinking);
  deck_case_close(&fine);
}

/* Contact about as stiff as the blocks: nothing is halved. */
static void contact_as_stiff_as_the_blocks_halves_nothing(void **state) {
  (void)state;
  deck_case fixed, shrinking;
  meet(&fixed, 0.25, 0, 2.165e9);
  meet(&shrinking, 0.25, 50, 2.165e9);
  int count;
  simulation_step_changes(shrinking.simulation, &count);
  print_message("step of contact %.3f of that without; momentum %.5f of the other\n",
                simulation_step_limit(fixed.simulation)->limit /
                    simulation_step_limit(shrinking.simulation)->limit,
                deck_case_last(&shrinking, "p") / deck_case_last(&fixed, "p"));
  assert_int_equal(count, 0);
  assert_true(fabs(deck_case_last(&shrinking, "p") / deck_case_last(&fixed, "p") - 1) < 3e-3);
  deck_case_close(&fixed);
  deck_case_close(&shrinking);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_crack_shortens_the_step),
      cmocka_unit_test(threads_and_stops_change_no_bit),
      cmocka_unit_test(a_solid_that_stiffens_shortens_the_step),
      cmocka_unit_test(blocks_meet_with_long_steps),
      cmocka_unit_test(contact_as_stiff_as_the_blocks_halves_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
