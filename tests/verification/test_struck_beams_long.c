/* The short step of examples/impact_beam, and how far rare advances of a crack shake the beam. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "deck_run.h"

/* K_I/K_Ic of another program with the same settings, at its looks: the first ones at or after 0.2,
   0.4 ... ms, the last before 1.5 ms. */
static void stress_intensities_of_the_struck_beam(void **state) {
  (void)state;
  const int look[] = {24, 48, 71, 95, 118, 142, 176};
  const double known[] = {.142, .439, .711, 1, 1.28, 1.564, 1.98};
  const deck_run r = run_begin("impact_beam/centre_notch.nml", "");
  const table *K = run_history(&r, "midspan/K_I");
  for (int k = 0; k < 7; k++)
    assert_true(fabs(history_at(K, look[k] * 8.487e-6) / 0.8e6 - known[k]) < 0.01 * known[k]);
  assert_true(fabs(history_first_above(K, 0.8e6) - 0.806e-3) < 1e-6);
  run_end(&r);
}

/* Driven nodes that give way reach K_Ic the later, the longer the step. */
static void driven_nodes_that_give_way(void **state) {
  (void)state;
  const double step[] = {2.829e-8, 5.658e-8, 1.060875e-7}, reach[] = {0.883e-3, 0.985e-3, 1.324e-3};
  for (int k = 0; k < 3; k++) {
    char change[256];
    snprintf(
        change, sizeof change,
        "--set newmark.motion=velocity_only --set simulation.step=%.7g --set tips.check_steps=%d",
        step[k], (int)lround(8.487e-6 / step[k]));
    const deck_run r = run_begin("impact_beam/centre_notch.nml", change);
    const double found = history_first_above(run_history(&r, "midspan/K_I"), 0.8e6);
    assert_true(fabs(found - reach[k]) < 1e-6);
    run_end(&r);
  }
}

/* Rms of the support's force about its mean over seven samples, from the crack's start on. */
static double swing(const deck_run *r) {
  enum { SIDE = 3 };
  const double begins = history_first_above(run_history(r, "midspan/speed"), 1);
  const table *force = run_history(r, "left_support");
  double sum = 0;
  int count = 0;
  for (int k = SIDE; k < force->count - SIDE; k++) {
    if (force->time[k] < begins) continue;
    double mean = 0;
    for (int n = -SIDE; n <= SIDE; n++)
      mean += force->value[k + n] / (2 * SIDE + 1);
    sum += (force->value[k] - mean) * (force->value[k] - mean);
    count++;
  }
  return sqrt(sum / count);
}

static void rare_advances_shake_the_beam(void **state) {
  (void)state;
  const int updates[] = {2, 3, 5, 15, 30};
  double before = INFINITY;
  for (int k = 0; k < 5; k++) {
    char change[64];
    snprintf(change, sizeof change, "--set tips.updates=%d", updates[k]);
    const deck_run r = run_begin("impact_beam/growing_notch.nml", change);
    const double now = swing(&r);
    print_message("an advance every %d steps: %.1f N\n", 1500 / updates[k], now);
    assert_true(now < before);
    before = now;
    run_end(&r);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(stress_intensities_of_the_struck_beam),
      cmocka_unit_test(driven_nodes_that_give_way),
      cmocka_unit_test(rare_advances_shake_the_beam),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
