/* The beam in space with bars and stirrups, on a coarse lattice: its strength and energies, and the
   same bits for any number of threads and after a checkpoint. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/runtime/hand_over.h"
#include "tests/runtime/same_runs.h"
#include "tests/verification/beam_in_space.h"

enum { CONCRETE, BOTTOM, BOND = 4 }; /* the deck's interactions */

static void it_carries_what_its_steel_bears(void **state) {
  (void)state;
  deck_case c;
  const char *const overrides[] = {"simulation.threads=1", "output.frames=0",
                                   "output.losses=.true.", COARSE};
  assert_true(deck_case_run(&c, BEAM_IN_SPACE, overrides, 5));
  assert_int_equal(deck_case_go(&c), STEP_END);
  carries_what_steel_bears(&c, "| 20 mm");
  const double *time;
  const long end = simulation_history(c.simulation, &time) - 1;
  const double imbalance = deck_case_series(&c, "energy/imbalance")[end],
               external = deck_case_series(&c, "energy/external")[end],
               lost = deck_case_series(&c, "energy/dissipated_damage")[end];
  print_message("external work %.4g J, lost %.4g J, imbalance %.2g J\n", external, lost, imbalance);
  assert_true(lost > 0.3 * external && fabs(imbalance) < 1e-3 * external);
  deck_case_close(&c);
}

/* --- bits ------------------------------------------------------------------------------------- */

/* Pressed down so fast that it cracks, slips and yields within 3 ms. */
static void open_fast(deck_case *c, const char *threads) {
  const char *const overrides[] = {threads,
                                   "simulation.end_time=3 ms",
                                   "drive[1].velocity=-0.6 m/s",
                                   "drive[2].velocity=-0.6 m/s",
                                   "drive[1].rise=1 ms",
                                   "drive[2].rise=1 ms",
                                   "output.frames=0",
                                   "output.losses=.true.",
                                   COARSE};
  assert_true(deck_case_run(c, BEAM_IN_SPACE, overrides, 10));
}

static void threads_and_stops_do_not_change_a_bit(void **state) {
  (void)state;
  static const char *const threads[] = {"simulation.threads=2", "simulation.threads=3"};
  deck_case one, more, rest;
  open_fast(&one, "simulation.threads=1");
  assert_int_equal(deck_case_go(&one), STEP_END);
  assert_true(touched(&one, CONCRETE, "omega_t") > 1000);
  assert_true(touched(&one, BOTTOM, "S_p") > 2);
  assert_true(touched(&one, BOND, "s_p") > 20);
  for (int k = 0; k < 2; k++) {
    open_fast(&more, threads[k]);
    if (k == 1) {
      open_fast(&rest, threads[0]);
      hand_over(more.simulation, 601, rest.simulation);
      assert_int_equal(deck_case_go(&rest), STEP_END);
      same_runs(one.simulation, rest.simulation);
      deck_case_close(&rest);
    }
    assert_int_equal(deck_case_go(&more), STEP_END);
    same_runs(one.simulation, more.simulation);
    deck_case_close(&more);
  }
  deck_case_close(&one);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(it_carries_what_its_steel_bears),
      cmocka_unit_test(threads_and_stops_do_not_change_a_bit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
